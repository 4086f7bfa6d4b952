// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/movers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "ydd/simulation/furniture.h"
#include "ydd/simulation/motions.h"
#include "ydd/simulation/pictures.h"
#include "ydd/simulation/room.h"
#include "ydd/simulation/surfaces.h"

namespace ydd::sim {
namespace {

constexpr double kRound = 2.0 * std::numbers::pi;

/// Around 0, at nearly the same speed to and fro, with rounded turns.
double to_and_fro(double t, double amplitude_m, double speed_m_s) {
  constexpr double kSharpness = 0.97;  // 1: a triangle wave
  const double corner = std::asin(kSharpness);
  const double phase = speed_m_s * corner / (kSharpness * amplitude_m) * t;
  return amplitude_m * std::asin(kSharpness * std::sin(phase)) / corner;
}

/// A picture full of corners: posters, covers and printed cloth, edge to edge.
Canvas paint_collage(SceneBuilder& builder, float width_m, float height_m) {
  constexpr float kCell_m = 0.24F;
  Random random = builder.next_random();
  Canvas canvas(builder.fine_texels(static_cast<double>(width_m)),
                builder.fine_texels(static_cast<double>(height_m)), grey(0.5F));
  const int columns = std::max(1, static_cast<int>(std::lround(width_m / kCell_m)));
  const int rows = std::max(1, static_cast<int>(std::lround(height_m / kCell_m)));
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int x0 = c * canvas.width() / columns;
      const int y0 = r * canvas.height() / rows;
      Canvas cell((c + 1) * canvas.width() / columns - x0, (r + 1) * canvas.height() / rows - y0,
                  grey(0.5F));
      const Random paint = random.fork(7);
      const auto kind = random.integer(0, 2);
      if (kind == 0) cell = paint_poster(paint, cell.width(), cell.height());
      if (kind == 1) cell = paint_cover(paint, cell.width(), cell.height());
      if (kind == 2) {
        const auto cloth = static_cast<Cloth>(random.integer(0, kClothKinds - 1));
        cell.paste(paint_cloth(paint, 512, 0.6F * builder.texel_m(), cloth), 0, 0);
      }
      canvas.paste(cell, x0, y0);
    }
  }
  return canvas;
}

/// A collage upright at the origin's y, facing -y, its lower edge at z, its middle at x = 0.
Part make_print(SceneBuilder& builder, int object, float width_m, float z, float height_m) {
  const Mesh sheet =
      make_panel({-0.5F * width_m, 0, z + height_m}, {width_m, 0, 0}, {0, 0, -height_m}, 0.25F);
  return builder.covered(sheet, builder.add_texture(paint_collage(builder, width_m, height_m)),
                         object);
}

/// A box from `z` upwards with a print on each of its sides.
Parts make_printed_box(SceneBuilder& builder, int object, const Vector3& size, float z,
                       int material) {
  constexpr float kRim_m = 0.02F;
  constexpr double kProud_m = 0.002;
  Parts parts = {builder.cut(make_box({0, 0, z + 0.5F * size.z()}, size, 0.25F), material, object)};
  for (int side = 0; side < 4; ++side) {
    const float width = side % 2 == 0 ? size.x() : size.y();
    const float depth = side % 2 == 0 ? size.y() : size.x();
    Part print = make_print(builder, object, width - 2 * kRim_m, z + kRim_m, size.z() - 2 * kRim_m);
    print.mesh =
        transformed(print.mesh, yaw(0.25 * kRound * side) *
                                    shift(0, -0.5 * static_cast<double>(depth) - kProud_m, 0));
    parts.push_back(std::move(print));
  }
  return parts;
}

void add_wheels(SceneBuilder& builder, int object, float x, float y, Parts& parts) {
  for (const float sx : {-x, x}) {
    for (const float sy : {-y, y}) {
      parts.push_back(builder.cut(make_ellipsoid({sx, sy, 0.05F}, {0.05F, 0.025F, 0.05F}, 12, 8),
                                  builder.palette().black, object));
    }
  }
}

/// A tall cabinet on wheels, covered with prints, rolls sideways to and fro.
void add_cabinet(SceneBuilder& builder) {
  const int object = builder.add_mover("thing", "rolling_cabinet");
  Parts parts =
      make_printed_box(builder, object, {0.64F, 0.45F, 1.7F}, 0.1F, builder.palette().dark_wood);
  add_wheels(builder, object, 0.26F, 0.17F, parts);
  Actor actor;
  actor.bodies = {{parts}};
  actor.poses = [](double t) {
    return std::vector<SE3>{shift(2.85 + to_and_fro(t, 0.75, 0.5), 3.05, 0)};
  };
  builder.add_actor(std::move(actor));
}

/// A printed curtain in pleats; it is drawn to and fro along its rail, the leading end faster than
/// the other one, so that the pleats open and close.
void add_curtain(SceneBuilder& builder) {
  constexpr int kPleats = 8;
  constexpr float kPleat_m = 0.15F;
  constexpr float kTop_m = 2.2F;
  const int object = builder.add_mover("thing", "curtain");
  const int cloth = builder.add_texture(
      paint_cloth(builder.next_random(), 1024, 0.6F * builder.texel_m(), Cloth::blocks),
      Wrap::repeat);
  Actor actor;
  for (int i = 0; i < kPleats; ++i) {
    const Mesh panel = make_panel({0, 0, kTop_m}, {kPleat_m, 0, 0}, {0, 0, 0.06F - kTop_m}, 0.25F);
    const Mesh piece = with_uv(panel, {kPleat_m, kTop_m}, {kPleat_m * static_cast<float>(i), 0});
    actor.bodies.push_back({{Part{
        piece, cloth, Eigen::Vector2f::Constant(1.0F / (0.6F * builder.texel_m())), object}}});
  }
  actor.poses = [](double t) {
    constexpr double kWidth_m = static_cast<double>(kPleat_m);
    constexpr double kLead_m = 0.45;
    const double way = to_and_fro(t, kLead_m, 0.5) / kLead_m;
    const double fold = std::acos((0.55 + 0.15 * way) / (kPleats * kWidth_m));
    std::vector<SE3> T;
    for (int i = 0; i < kPleats; ++i) {
      const bool away = i % 2 == 0;  // the pleat's right end is the farther one
      T.push_back(shift(2.3 + 0.3 * way + i * kWidth_m * std::cos(fold),
                        2.8 + (away ? 0.0 : kWidth_m * std::sin(fold)), 0) *
                  yaw(away ? fold : -fold));
    }
    return T;
  };
  builder.add_actor(std::move(actor));
  const int steel = builder.palette().steel;
  Parts rail = {
      builder.cut(make_box({2.8F, 2.85F, kTop_m + 0.02F}, {2.2F, 0.03F, 0.03F}), steel, -1)};
  const auto ceiling = static_cast<float>(kRoomHeight_m);
  for (const float x : {1.75F, 3.85F}) {
    rail.push_back(builder.cut(
        make_box({x, 2.85F, 0.5F * (kTop_m + ceiling)}, {0.02F, 0.02F, ceiling - kTop_m}), steel,
        -1));
  }
  builder.place(rail, SE3());
}

/// A door leaf full of posters turns about a jamb that stands in the room.
void add_door(SceneBuilder& builder) {
  constexpr float kLeaf_m = 0.85F;
  constexpr float kHeight_m = 2.05F;
  const SE3 T_world_hinge = shift(2.35, 2.85, 0);
  const int object = builder.add_mover("thing", "door_leaf");
  Parts parts = make_printed_box(builder, object, {kLeaf_m, 0.05F, kHeight_m}, 0.02F,
                                 builder.palette().pale_wood);
  for (const float side : {-1.0F, 1.0F}) {
    parts.push_back(builder.cut(make_box({0.34F, 0.05F * side, 1.05F}, {0.12F, 0.03F, 0.025F}),
                                builder.palette().steel, object));
  }
  for (Part& part : parts) {
    part.mesh = transformed(part.mesh, shift(0.5 * static_cast<double>(kLeaf_m) + 0.04, 0, 0));
  }
  Actor actor;
  actor.bodies = {{parts}};
  actor.poses = [T_world_hinge](double t) {
    constexpr double kMiddle_rad = 0.35;
    constexpr double kSwing_rad = 0.7;
    constexpr double kPeriod_s = 6.0;
    const double angle = kMiddle_rad - kSwing_rad * std::cos(kRound * t / kPeriod_s);
    return std::vector<SE3>{T_world_hinge * yaw(angle)};
  };
  builder.add_actor(std::move(actor));
  const auto ceiling = static_cast<float>(kRoomHeight_m);
  builder.place({builder.cut(make_box({0, 0, 0.5F * ceiling}, {0.07F, 0.09F, ceiling}, 0.2F),
                             builder.palette().dark_wood, -1)},
                T_world_hinge);
}

/// A robot with a body and a head of printed panels drives a figure of eight and turns with it.
void add_robot(SceneBuilder& builder) {
  const Palette& p = builder.palette();
  const int object = builder.add_mover("thing", "robot");
  Parts parts = make_printed_box(builder, object, {0.62F, 0.62F, 1.2F}, 0.1F, p.steel);
  const Parts head = make_printed_box(builder, object, {0.4F, 0.4F, 0.34F}, 1.4F, p.white);
  parts.insert(parts.end(), head.begin(), head.end());
  parts.push_back(builder.cut(make_lathe({{0.09F, 1.29F}, {0.09F, 1.41F}}, 16), p.black, object));
  parts.push_back(builder.cut(make_lathe({{0.01F, 1.74F}, {0.01F, 2.0F}}, 8), p.black, object));
  add_wheels(builder, object, 0.25F, 0.22F, parts);
  Actor actor;
  actor.bodies = {{parts}};
  actor.poses = [](double t) {
    constexpr double kHalfX_m = 0.55;
    constexpr double kHalfY_m = 0.16;
    const double phase = kRound * t / 8.0;
    const double heading =
        std::atan2(2.0 * kHalfY_m * std::cos(2.0 * phase), kHalfX_m * std::cos(phase));
    return std::vector<SE3>{
        shift(2.85 + kHalfX_m * std::sin(phase), 2.85 + kHalfY_m * std::sin(2.0 * phase), 0) *
        yaw(heading)};
  };
  builder.add_actor(std::move(actor));
}

// The picture of the screen lies on strips that run upwards behind the opening of the frame, one
// above the other. The frame's bars are as high as a strip: one that has gone behind the upper bar
// starts again behind the lower one.
constexpr int kStrips = 9;
constexpr float kStrip_m = 0.105F;
constexpr float kOpening_m = kStrip_m * static_cast<float>(kStrips - 1);

/// The frame around the opening and its foot, in the frame of the strips: z = 0 is the lower end of
/// the lowest strip, `floor_m` below it the floor.
Parts make_screen_frame(SceneBuilder& builder, float width_m, float floor_m) {
  constexpr float kLip_m = 0.01F;  // the bars reach into the opening: nobody looks behind them
  constexpr float kFront_m = -0.02F;
  const Palette& p = builder.palette();
  const float height = kOpening_m + 2 * kStrip_m;
  const float bar = kStrip_m + kLip_m;
  const float outer = width_m + 2 * 0.05F;
  Parts parts;
  for (const float z : {0.5F * bar, height - 0.5F * bar}) {
    parts.push_back(builder.cut(make_box({0, kFront_m, z}, {outer, 0.03F, bar}), p.dark_wood, -1));
  }
  for (const float side : {-1.0F, 1.0F}) {
    parts.push_back(builder.cut(make_box({0.5F * side * (width_m + 0.04F), kFront_m, 0.5F * height},
                                         {0.06F, 0.03F, height}),
                                p.dark_wood, -1));
  }
  parts.push_back(
      builder.cut(make_box({0, 0.04F, 0.5F * height}, {outer, 0.06F, height}), p.black, -1));
  parts.push_back(
      builder.cut(make_box({0, 0.04F, -0.5F * floor_m}, {0.1F, 0.05F, floor_m}), p.steel, -1));
  parts.push_back(
      builder.cut(make_box({0, 0.04F, 0.02F - floor_m}, {0.7F, 0.4F, 0.04F}), p.steel, -1));
  return parts;
}

/// A large display that stands still; its picture scrolls.
void add_screen(SceneBuilder& builder) {
  constexpr float kWidth_m = 1.06F;
  constexpr float kBottom_m = 0.75F;
  constexpr double kSpeed_m_s = 0.3;
  const SE3 T_world_screen = shift(2.85, 3.05, static_cast<double>(kBottom_m));
  const int object = builder.add_mover("thing", "scrolling_screen");
  const int picture = builder.add_texture(paint_collage(builder, kWidth_m, kOpening_m + kStrip_m));
  Actor actor;
  for (int i = 0; i < kStrips; ++i) {
    const Mesh strip =
        make_panel({-0.5F * kWidth_m, 0, kStrip_m}, {kWidth_m, 0, 0}, {0, 0, -kStrip_m}, 0.25F);
    const float share = 1.0F / static_cast<float>(kStrips);
    Part part = builder.covered(
        with_uv(strip, {1.0F, share}, {0, share * static_cast<float>(kStrips - 1 - i)}), picture,
        object);
    part.glow = 0.95F;
    actor.bodies.push_back({{std::move(part)}});
  }
  actor.poses = [T_world_screen](double t) {
    constexpr double kHeight_m = static_cast<double>(kStrip_m);
    constexpr double kLoop_m = kStrips * kHeight_m;
    std::vector<SE3> T;
    for (int i = 0; i < kStrips; ++i) {
      const double way = i * kHeight_m + kSpeed_m_s * t;
      T.push_back(T_world_screen * shift(0, 0, way - kLoop_m * std::floor(way / kLoop_m)));
    }
    return T;
  };
  builder.add_actor(std::move(actor));
  builder.place(make_screen_frame(builder, kWidth_m, kBottom_m), T_world_screen);
}

}  // namespace

void add_large_mover(SceneBuilder& builder, const WorldOptions& options) {
  builder.reseed(Random(mix_bits(static_cast<std::uint64_t>(options.seed), 4242)));
  switch (options.mover) {
    case MoverKind::none:
      break;
    case MoverKind::cabinet:
      return add_cabinet(builder);
    case MoverKind::curtain:
      return add_curtain(builder);
    case MoverKind::door:
      return add_door(builder);
    case MoverKind::robot:
      return add_robot(builder);
    case MoverKind::screen:
      return add_screen(builder);
  }
}

}  // namespace ydd::sim
