// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/room.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ydd/simulation/furniture.h"
#include "ydd/simulation/pictures.h"
#include "ydd/simulation/surfaces.h"

namespace ydd::sim {
namespace {

constexpr auto kW = static_cast<float>(kRoomWidth_m);
constexpr auto kD = static_cast<float>(kRoomDepth_m);
constexpr auto kH = static_cast<float>(kRoomHeight_m);
constexpr float kDoorHeight_m = 2.05F;
constexpr double kBusyWalls = 0.4;
constexpr float kLampPower = 2.4F;
constexpr float kCell_m = 0.2F;  // of baked light on large surfaces

SE3 at(double x, double y, double z = 0, double turn_rad = 0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ())),
          Eigen::Vector3d(x, y, z)};
}

/// A wall as seen from inside: its frame has x to the right along the wall, -y into the room, the
/// origin at its lower left corner.
struct Wall {
  SE3 T_room_wall;
  float length_m;
  bool passage;             ///< an opening to the next room
  float passage_mid_m = 0;  ///< along the wall
};

std::array<Wall, 4> walls_of_room(int room, int rooms) {
  constexpr double kRight = 0.5 * std::numbers::pi;
  const auto mid = static_cast<float>(kDoorMiddle_m);
  return {Wall{at(0, kRoomDepth_m), kW, false},  // north
          Wall{at(kRoomWidth_m, kRoomDepth_m, 0, -kRight), kD, room + 1 < rooms, kD - mid},  // east
          Wall{at(kRoomWidth_m, 0, 0, 2 * kRight), kW, false},  // south
          Wall{at(0, 0, 0, kRight), kD, room > 0, mid}};        // west
}

class RoomBuilder {
 public:
  RoomBuilder(SceneBuilder& builder, const WorldOptions& options, int room)
      : builder_(builder),
        options_(options),
        room_(room),
        T_world_room_(at(room * kRoomPitch_m, 0)),
        walls_(walls_of_room(room, options.rooms)) {}

  void build(const std::array<bool, 2>& fixed_chair) {
    build_floor_and_ceiling();
    for (int i = 0; i < 4; ++i) build_wall(i);
    furnish_north(fixed_chair);
    furnish_east();
    furnish_south();
    furnish_west();
    add_changing_lights();
  }

 private:
  void place(const Parts& parts, const SE3& T_room_parts) {
    builder_.place(parts, T_world_room_ * T_room_parts);
  }
  /// On or before a wall: `along` from its left end, `out` into the room.
  void place_at_wall(int wall, const Parts& parts, double along, double z = 0, double out = 0) {
    place(parts, walls_[wall].T_room_wall * at(along, -out, z));
  }
  /// Loud clothes before a quiet wall: what a crowd does to a tracker.
  double wall_detail() const { return (options_.busy ? kBusyWalls : 1.0) * options_.wall_detail; }
  int texels(float metres) const { return static_cast<int>(metres / builder_.texel_m()); }
  Part picture(const Canvas& canvas, const Mesh& mesh) {
    return builder_.covered(mesh, builder_.add_texture(canvas), -1);
  }

  void build_floor_and_ceiling();
  void build_wall(int wall);
  void hang_posters(int wall, float x0, float x1, float z0, float z1);
  void hang(int wall, const Canvas& canvas, float along, float z, float width, float height);
  void furnish_desk(int wall, float along, int monitors, std::uint64_t number);
  void furnish_north(const std::array<bool, 2>& fixed_chair);
  void furnish_east();
  void furnish_south();
  void furnish_west();
  void add_changing_lights();

  SceneBuilder& builder_;
  const WorldOptions& options_;
  int room_;
  SE3 T_world_room_;
  std::array<Wall, 4> walls_;
};

void RoomBuilder::build_floor_and_ceiling() {
  const Mesh floor = make_panel({0, kD, 0}, {kW, 0, 0}, {0, -kD, 0}, kCell_m);
  place({picture(paint_boards(builder_.next_random(), texels(kW), texels(kD), builder_.texel_m()),
                 floor)},
        SE3());
  const Mesh ceiling = make_panel({0, 0, kH}, {kW, 0, 0}, {0, kD, 0}, kCell_m);
  const float coarse = 2.0F * builder_.texel_m();
  place({picture(paint_ceiling(builder_.next_random(), static_cast<int>(kW / coarse),
                               static_cast<int>(kD / coarse), coarse),
                 ceiling)},
        SE3());
  const Mesh rug = make_panel({1.9F, 3.3F, 0.006F}, {2.4F, 0, 0}, {0, -1.7F, 0}, kCell_m);
  place({picture(paint_rug(builder_.next_random(), texels(2.4F), texels(1.7F), builder_.texel_m()),
                 rug)},
        SE3());
  for (const float x : {1.5F, 4.5F}) {
    for (const float y : {1.5F, 3.6F}) {
      const Vector3 half(0.6F, 0.15F, 0.02F);
      Part lamp =
          builder_.cut(make_box({x, y, kH - 0.03F}, 2.0F * half), builder_.palette().white, -1);
      lamp.glow = 1.25F;
      lamp.source = LightSource::ceiling;
      place({lamp}, SE3());
      const Vector3 centre =
          (T_world_room_ * Eigen::Vector3d(x, y, kRoomHeight_m - 0.06)).cast<float>();
      builder_.add_lamp({centre, half, kLampPower});
    }
  }
}

void RoomBuilder::build_wall(int index) {
  const Wall& wall = walls_[index];
  Random random = builder_.next_random();
  const float saturation = random.uniform_f(0.03F, 0.14F);
  const Colour base = hsv(random.uniform_f(0.05F, 0.6F), saturation, 0.8F);
  const auto contrast = static_cast<float>(0.3 + 0.7 * wall_detail());
  const int paint = builder_.add_texture(
      paint_plaster(random.fork(1), texels(wall.length_m), texels(kH), base, contrast));
  // A piece of the wall between x0, x1 and z0, z1, with its piece of the paint.
  const auto piece = [&](float x0, float x1, float z0, float z1) {
    const Mesh panel = make_panel({x0, 0, z1}, {x1 - x0, 0, 0}, {0, 0, z0 - z1}, kCell_m);
    const Eigen::Vector2f scale((x1 - x0) / wall.length_m, (z1 - z0) / kH);
    return builder_.covered(with_uv(panel, scale, {x0 / wall.length_m, 1.0F - z1 / kH}), paint, -1);
  };
  Parts parts;
  if (wall.passage) {
    const float left = wall.passage_mid_m - 0.5F * static_cast<float>(kDoorWidth_m);
    const float right = left + static_cast<float>(kDoorWidth_m);
    const auto thickness = static_cast<float>(kRoomPitch_m - kRoomWidth_m);
    parts = {piece(0, left, 0, kH), piece(right, wall.length_m, 0, kH),
             piece(left, right, kDoorHeight_m, kH)};
    const int wood = builder_.palette().dark_wood;
    for (const float x : {left - 0.03F, right + 0.03F}) {
      parts.push_back(builder_.cut(make_box({x, 0.25F * thickness, 0.5F * kDoorHeight_m},
                                            {0.08F, 0.5F * thickness + 0.06F, kDoorHeight_m}),
                                   wood, -1));
    }
    parts.push_back(
        builder_.cut(make_box({wall.passage_mid_m, 0.25F * thickness, kDoorHeight_m + 0.03F},
                              {static_cast<float>(kDoorWidth_m), 0.5F * thickness + 0.06F, 0.08F}),
                     wood, -1));
    const Vector3 sill(left, 0.5F * thickness + 0.005F, -0.001F);
    parts.push_back(builder_.cut(
        make_panel(sill, {right - left, 0, 0}, {0, -thickness, 0}, kCell_m), wood, -1));
  } else {
    parts = {piece(0, wall.length_m, 0, kH)};
    parts.push_back(builder_.cut(
        make_box({0.5F * wall.length_m, -0.01F, 0.045F}, {wall.length_m, 0.02F, 0.09F}),
        builder_.palette().dark_wood, -1));
  }
  place(parts, wall.T_room_wall);
}

void RoomBuilder::hang(int wall, const Canvas& canvas, float along, float z, float width,
                       float height) {
  place_at_wall(wall, make_hanging(builder_, canvas, width, height), static_cast<double>(along),
                static_cast<double>(z));
}

void RoomBuilder::hang_posters(int wall, float x0, float x1, float z0, float z1) {
  Random random = builder_.next_random();
  if (options_.repeated_posters) random = Random(static_cast<std::uint64_t>(options_.seed));
  for (float x = x0; x < x1 - 0.3F;) {
    const float width = std::min(random.uniform_f(0.32F, 0.72F), x1 - x);
    float bottom = z0 + random.uniform_f(0.0F, 0.12F);
    while (bottom < z1 - 0.25F) {
      const float height = std::min(width * random.uniform_f(0.75F, 1.4F), z1 - bottom);
      const bool used = random.chance(wall_detail());
      const Random paint = random.fork(3);
      if (used) {
        hang(wall, paint_poster(paint, builder_.fine_texels(width), builder_.fine_texels(height)),
             x + 0.5F * width, bottom + 0.5F * height, width, height);
      }
      bottom += height + random.uniform_f(0.04F, 0.15F);
    }
    x += width + random.uniform_f(0.05F, 0.2F);
  }
}

void RoomBuilder::furnish_desk(int wall, float along, int monitors, std::uint64_t number) {
  Random random = builder_.next_random();
  if (options_.identical_desks) {
    random = Random(mix_bits(static_cast<std::uint64_t>(options_.seed), 77));
    builder_.reseed(random.fork(1));
  } else {
    builder_.reseed(random.fork(number));
  }
  const double z = 0.752;
  const auto put = [&](const Parts& parts, double x, double out, double turn_rad) {
    place(parts, walls_[wall].T_room_wall * at(static_cast<double>(along) + x, -out, z, turn_rad));
  };
  place_at_wall(wall, make_desk(builder_, 1.6F, 0.78F), static_cast<double>(along), 0, 0.02);
  for (int i = 0; i < monitors; ++i) {
    const double x = monitors == 1 ? -0.1 : -0.38 + 0.62 * i;
    put(make_monitor(builder_, builder_.add_object("monitor"), 0.55F), x, 0.3,
        monitors == 1 ? 0.0 : 0.12 - 0.24 * i);
  }
  put(make_keyboard(builder_, builder_.add_object("keyboard")), -0.1, 0.6,
      random.uniform(-0.1, 0.1));
  put(make_mouse(builder_, builder_.add_object("mouse")), 0.22, 0.6, random.uniform(-0.3, 0.3));
  const double mug_turn_rad = random.uniform(0.0, 6.0);
  const double mug_out = 0.45 + random.uniform(0.0, 0.15);
  put(make_mug(builder_, builder_.add_object("cup")), 0.45, mug_out, mug_turn_rad);
  for (int pile = 0; pile < 2; ++pile) {
    const double x = pile == 0 ? 0.6 : -0.66;
    const double turn_rad = random.uniform(-0.5, 0.5);
    const double out = random.uniform(0.25, 0.6);
    put(make_flat_book(builder_, builder_.add_object("book"), 0.2F, 0.27F), x, out, turn_rad);
  }
}

void RoomBuilder::furnish_north(const std::array<bool, 2>& fixed_chair) {
  furnish_desk(0, 1.15F, 2, 1);
  furnish_desk(0, 2.8F, 2, 2);
  for (int i = 0; i < 2; ++i) {
    if (room_ == 0 && !fixed_chair[i]) continue;
    place(make_chair(builder_, builder_.add_object("chair")),
          at(kChairPlaces_m[i][0] + options_.chairs_moved_m, kChairPlaces_m[i][1], 0,
             std::numbers::pi + 0.35 - 0.5 * i));
  }
  place_at_wall(0, make_cabinet(builder_, 0.85F, 0.9F), 4.1);
  place_at_wall(0, make_bookcase(builder_, 1.1F, 1.9F), 5.15);
  const float board_z = 1.62F;
  place_at_wall(0,
                {builder_.cut(make_box({0, -0.11F, board_z}, {1.1F, 0.22F, 0.025F}),
                              builder_.palette().dark_wood, -1)},
                2.85);
  place_at_wall(0, make_book_row(builder_, 1.0F, 0.28F, true), 2.85,
                static_cast<double>(board_z) + 0.0135);
  hang_posters(0, 0.1F, 2.2F, 1.32F, 2.6F);
  hang_posters(0, 2.25F, 3.4F, 1.98F, 2.6F);
  hang_posters(0, 3.48F, 4.55F, 1.3F, 2.6F);
  hang_posters(0, 4.65F, 5.9F, 2.0F, 2.6F);
}

void RoomBuilder::furnish_east() {
  place_at_wall(1, make_bookcase(builder_, 1.2F, 1.85F), 1.15);
  place_at_wall(1, make_cabinet(builder_, 1.3F, 0.85F), 3.95);
  place_at_wall(1, make_plant(builder_, 0.9F), 3.6, 0.85, 0.22);
  for (int i = 0; i < 3; ++i) {
    place_at_wall(1, make_flat_book(builder_, builder_.add_object("book"), 0.22F, 0.28F),
                  3.9 + 0.25 * i, 0.85, 0.22);
  }
  hang_posters(1, 0.1F, 1.85F, 1.95F, 2.6F);
  if (!walls_[1].passage) hang_posters(1, 1.95F, 3.05F, 0.95F, 2.6F);
  hang_posters(1, 3.15F, 4.9F, 1.25F, 2.6F);
}

void RoomBuilder::furnish_south() {
  const Random random = builder_.next_random();
  hang(2, paint_door(random.fork(1), texels(0.95F), texels(2.05F)), 0.75F, 1.03F, 0.95F, 2.05F);
  hang(2, paint_whiteboard(random.fork(2), builder_.fine_texels(1.9), builder_.fine_texels(1.1)),
       3.0F, 1.65F, 1.9F, 1.1F);
  place_at_wall(2, make_cabinet(builder_, 1.4F, 0.75F), 3.0);
  place_at_wall(2, make_mug(builder_, builder_.add_object("cup")), 2.7, 0.75, 0.2);
  place_at_wall(2, make_flat_book(builder_, builder_.add_object("book"), 0.2F, 0.26F), 3.3, 0.75,
                0.2);
  place_at_wall(2, make_bookcase(builder_, 1.3F, 1.85F), 4.95);
  hang_posters(2, 1.4F, 2.0F, 0.9F, 2.5F);
  hang_posters(2, 4.1F, 5.9F, 1.95F, 2.6F);
}

void RoomBuilder::furnish_west() {
  const Random random = builder_.next_random();
  furnish_desk(3, 1.15F, 1, 3);
  hang(3, paint_pinboard(random.fork(2), builder_.fine_texels(1.4), builder_.fine_texels(1.0)),
       1.15F, 1.85F, 1.4F, 1.0F);
  Parts window = make_hanging(
      builder_, paint_window(random.fork(1), builder_.fine_texels(1.5), builder_.fine_texels(1.2)),
      1.5F, 1.2F);
  window.front().glow = 1.05F;
  window.front().source = LightSource::window;
  place_at_wall(3, window, 3.95, 1.75);
  place_at_wall(3, make_cabinet(builder_, 1.0F, 0.8F), 3.6);
  place_at_wall(3, make_plant(builder_, 0.75F), 3.35, 0.8, 0.22);
  if (!walls_[3].passage) hang_posters(3, 2.05F, 3.05F, 0.95F, 2.6F);
}

/// The window, and lamps at the desks and in the corner far from them. They draw no random numbers
/// and have no bodies: the world is the same whatever shines in it.
void RoomBuilder::add_changing_lights() {
  const auto placed = [&](const SE3& T_room_wall, double along, double out, double z) -> Vector3 {
    return (T_world_room_ * T_room_wall * Eigen::Vector3d(along, -out, z)).cast<float>();
  };
  builder_.add_window(
      {placed(walls_[3].T_room_wall, 3.95, 0.05, 1.75), {0, 1.5F, 1.2F}, 5.0F, Vector3::UnitX()});
  const Vector3 bulb(0.12F, 0.12F, 0.12F);
  const auto add = [&](int wall, double along, double out, double z, float power) {
    builder_.add_desk_lamp(
        {placed(walls_[wall].T_room_wall, along, out, z), bulb, power, Vector3::Zero()});
  };
  add(0, 1.15, 0.5, 1.3, 0.4F);
  add(0, 2.8, 0.5, 1.3, 0.4F);
  add(3, 1.15, 0.5, 1.3, 0.4F);
  add(1, 4.6, 0.5, 1.8, 0.7F);
}

}  // namespace

void build_rooms(SceneBuilder& builder, const WorldOptions& options,
                 const std::array<bool, 2>& fixed_chair) {
  for (int room = 0; room < options.rooms; ++room) {
    RoomBuilder(builder, options, room).build(fixed_chair);
  }
}

}  // namespace ydd::sim
