// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ydd/simulation/motions.h"
#include "ydd/simulation/pictures.h"
#include "ydd/simulation/surfaces.h"

namespace ydd::sim {
namespace {

/// Picture of `width_m` x `height_m` upright at y, facing -y, with its lower left corner at x, z.
Mesh upright(float x, float y, float z, float width_m, float height_m) {
  return make_panel({x, y, z + height_m}, {width_m, 0, 0}, {0, 0, -height_m}, 0.25F);
}

/// Picture lying at height z, its upper edge away from the viewer at -y.
Mesh lying(float x, float y, float z, float width_m, float depth_m) {
  return make_panel({x - 0.5F * width_m, y + 0.5F * depth_m, z}, {width_m, 0, 0}, {0, -depth_m, 0},
                    0.25F);
}

void append(Parts& parts, const Parts& more, const SE3& T) {
  for (Part part : more) {
    part.mesh = transformed(part.mesh, T);
    parts.push_back(std::move(part));
  }
}

}  // namespace

Parts make_desk(SceneBuilder& builder, float width_m, float depth_m) {
  const Palette& p = builder.palette();
  const float mid = -0.5F * depth_m;
  Parts parts;
  parts.push_back(
      builder.cut(make_box({0, mid, 0.735F}, {width_m, depth_m, 0.03F}, 0.12F), p.pale_wood, -1));
  for (const float side : {-1.0F, 1.0F}) {
    const float x = side * (0.5F * width_m - 0.05F);
    parts.push_back(
        builder.cut(make_box({x, mid, 0.36F}, {0.04F, depth_m - 0.1F, 0.72F}, 0.2F), p.steel, -1));
  }
  parts.push_back(builder.cut(
      make_box({0.3F * width_m, mid, 0.43F}, {0.4F, depth_m - 0.1F, 0.56F}, 0.2F), p.white, -1));
  for (const float z : {0.24F, 0.43F, 0.62F}) {
    parts.push_back(builder.cut(
        make_box({0.3F * width_m, 0.04F - depth_m, z}, {0.16F, 0.02F, 0.02F}), p.black, -1));
  }
  return parts;
}

Parts make_chair(SceneBuilder& builder, int object) {
  const Palette& p = builder.palette();
  const int cloth = p.leather;
  Parts parts;
  parts.push_back(builder.cut(make_loft({{0.42F, 0.20F, 0.20F, 0, 0, 4},
                                         {0.44F, 0.24F, 0.24F, 0, 0, 4},
                                         {0.48F, 0.24F, 0.24F, 0, 0, 4},
                                         {0.5F, 0.21F, 0.21F, 0, 0, 4}},
                                        24),
                              cloth, object));
  parts.push_back(builder.cut(make_loft({{0.58F, 0.18F, 0.02F, 0, 0.23F, 4},
                                         {0.62F, 0.22F, 0.03F, 0, 0.24F, 4},
                                         {0.80F, 0.23F, 0.03F, 0, 0.27F, 4},
                                         {0.95F, 0.19F, 0.025F, 0, 0.29F, 4}},
                                        24),
                              cloth, object));
  parts.push_back(builder.cut(make_box({0, 0.25F, 0.52F}, {0.06F, 0.03F, 0.24F}), p.black, object));
  parts.push_back(builder.cut(make_lathe({{0.03F, 0.08F}, {0.03F, 0.43F}}, 10), p.steel, object));
  for (int leg = 0; leg < 5; ++leg) {
    const SE3 T = turn(Eigen::Vector3d::UnitZ(), 2.0 * std::numbers::pi * leg / 5.0);
    const Mesh beam = make_box({0.15F, 0, 0.08F}, {0.3F, 0.04F, 0.03F});
    parts.push_back(builder.cut(transformed(beam, T), p.black, object));
    const Mesh wheel = make_ellipsoid({0.29F, 0, 0.032F}, {0.03F, 0.02F, 0.03F}, 8, 6);
    parts.push_back(builder.cut(transformed(wheel, T), p.black, object));
  }
  for (const float s : {-1.0F, 1.0F}) {
    parts.push_back(
        builder.cut(make_box({0.27F * s, 0.05F, 0.66F}, {0.05F, 0.26F, 0.03F}), p.black, object));
    parts.push_back(
        builder.cut(make_box({0.27F * s, 0.1F, 0.55F}, {0.03F, 0.04F, 0.2F}), p.steel, object));
  }
  return parts;
}

Parts make_monitor(SceneBuilder& builder, int object, float width_m) {
  const Palette& p = builder.palette();
  const float height = 0.6F * width_m;
  const float bottom = 0.11F;
  const int screen = builder.add_texture(paint_screen(
      builder.next_random(), builder.fine_texels(width_m), builder.fine_texels(height)));
  const float rim = 0.012F;
  Parts parts;
  parts.push_back(builder.cut(
      make_box({0, 0.02F, bottom + 0.5F * height}, {width_m + 2 * rim, 0.035F, height + 2 * rim}),
      p.black, object));
  parts.push_back(
      builder.covered(upright(-0.5F * width_m, 0.0F, bottom, width_m, height), screen, object));
  parts.back().glow = 0.95F;
  parts.push_back(builder.cut(make_box({0, 0.05F, 0.11F}, {0.06F, 0.02F, 0.2F}), p.black, object));
  parts.push_back(
      builder.cut(make_box({0, 0.04F, 0.008F}, {0.24F, 0.18F, 0.016F}), p.black, object));
  return parts;
}

Parts make_keyboard(SceneBuilder& builder, int object) {
  const float width = 0.44F;
  const float depth = 0.14F;
  const int keys = builder.add_texture(paint_keyboard(
      builder.next_random(), builder.fine_texels(width), builder.fine_texels(depth)));
  Parts parts;
  parts.push_back(
      builder.cut(make_box({0, 0, 0.01F}, {width, depth, 0.02F}), builder.palette().black, object));
  parts.push_back(builder.covered(lying(0, 0, 0.0215F, width, depth), keys, object));
  return parts;
}

Parts make_mouse(SceneBuilder& builder, int object) {
  return {builder.cut(make_ellipsoid({0, 0, 0.01F}, {0.03F, 0.055F, 0.025F}, 14, 10),
                      builder.palette().white, object)};
}

Parts make_mug(SceneBuilder& builder, int object) {
  const int print = builder.add_texture(
      paint_mug(builder.next_random(), builder.fine_texels(0.26), builder.fine_texels(0.1)));
  constexpr float kRadius = 0.041F;
  // The wall is a strip of panels, so that the print covers [0, 1].
  Mesh wall = make_lathe({{kRadius, 0.0F}, {kRadius, 0.1F}}, 20);
  for (std::size_t i = 0; i < wall.uvs.size(); ++i) {
    wall.uvs[i] = {static_cast<float>(i % 21) / 20.0F, 1.0F - wall.positions[i].z() / 0.1F};
  }
  Parts parts;
  parts.push_back(builder.covered(wall, print, object));
  for (int i = 0; i < 6; ++i) {  // the handle, an arc of short rods
    const float angle = std::numbers::pi_v<float> * (-0.5F + (static_cast<float>(i) + 0.5F) / 6.0F);
    const Mesh rod = make_box({0, 0, 0}, {0.010F, 0.012F, 0.022F});
    const SE3 T = shift(kRadius + 0.03 * std::cos(angle), 0, 0.05 + 0.033 * std::sin(angle)) *
                  turn(Eigen::Vector3d::UnitY(), -static_cast<double>(angle));
    parts.push_back(builder.cut(transformed(rod, T), builder.palette().white, object));
  }
  return parts;
}

Parts make_flat_book(SceneBuilder& builder, int object, float width_m, float height_m) {
  Random random = builder.next_random();
  const int cover = builder.add_texture(
      paint_cover(random, builder.fine_texels(width_m), builder.fine_texels(height_m)));
  const float thickness = random.uniform_f(0.015F, 0.045F);
  Parts parts;
  parts.push_back(builder.cut(make_box({0, 0, 0.5F * thickness}, {width_m, height_m, thickness}),
                              builder.palette().white, object));
  parts.push_back(
      builder.covered(lying(0, 0, thickness + 0.0015F, width_m, height_m), cover, object));
  return parts;
}

Parts make_book_row(SceneBuilder& builder, float width_m, float max_height_m, bool objects) {
  Random random = builder.next_random();
  Parts parts;
  for (float x = -0.5F * width_m; x < 0.5F * width_m - 0.07F;) {
    const float thickness = random.uniform_f(0.02F, 0.065F);
    const float height = max_height_m * random.uniform_f(0.65F, 0.97F);
    const float depth = random.uniform_f(0.15F, 0.2F);
    const int object = objects ? builder.add_object("book") : -1;
    const int spine = builder.add_texture(
        paint_spine(random.fork(1), builder.fine_texels(thickness), builder.fine_texels(height)));
    const float front = -depth - random.uniform_f(0.0F, 0.03F);
    const Mesh block = make_box({x + 0.5F * thickness, 0.5F * front, 0.5F * height},
                                {thickness - 0.002F, -front, height});
    parts.push_back(builder.covered(with_uv(block, {0.5F, 0.5F}, {0, 0}), spine, object));
    parts.push_back(
        builder.covered(upright(x, front - 0.001F, 0, thickness - 0.002F, height), spine, object));
    x += thickness;
    if (random.chance(0.08)) x += random.uniform_f(0.03F, 0.12F);
  }
  return parts;
}

Parts make_bookcase(SceneBuilder& builder, float width_m, float height_m) {
  const int wood = builder.palette().dark_wood;
  const float depth = 0.3F;
  const float mid = -0.5F * depth;
  const float board = 0.025F;
  Parts parts;
  parts.push_back(
      builder.cut(make_box({0, -0.01F, 0.5F * height_m}, {width_m, 0.02F, height_m}), wood, -1));
  for (const float s : {-1.0F, 1.0F}) {
    parts.push_back(
        builder.cut(make_box({s * 0.5F * (width_m - board), mid - 0.01F, 0.5F * height_m},
                             {board, depth, height_m}, 0.2F),
                    wood, -1));
  }
  const int levels = static_cast<int>(height_m / 0.36F);
  for (int i = 0; i <= levels; ++i) {
    const float z = 0.05F + (height_m - 0.08F) * static_cast<float>(i) / static_cast<float>(levels);
    parts.push_back(builder.cut(
        make_box({0, mid - 0.012F, z}, {width_m - 2.2F * board, depth - 0.01F, board}, 0.15F), wood,
        -1));
    if (i == levels) break;
    const float inner = width_m - 3.0F * board;
    append(parts, make_book_row(builder, inner, 0.29F, false),
           shift(0, -0.03, static_cast<double>(z + 0.51F * board)));
  }
  return parts;
}

Parts make_cabinet(SceneBuilder& builder, float width_m, float height_m) {
  const Palette& p = builder.palette();
  const float depth = 0.45F;
  Parts parts;
  parts.push_back(
      builder.cut(make_box({0, -0.5F * depth, 0.5F * height_m}, {width_m, depth, height_m}, 0.2F),
                  p.pale_wood, -1));
  const int doors = std::max(1, static_cast<int>(width_m / 0.45F));
  const float door = width_m / static_cast<float>(doors);
  for (int i = 0; i < doors; ++i) {
    const float x = -0.5F * width_m + door * (static_cast<float>(i) + 0.5F);
    parts.push_back(builder.cut(make_box({x, -depth - 0.008F, 0.5F * height_m},
                                         {door - 0.02F, 0.016F, height_m - 0.06F}, 0.25F),
                                i % 2 == 0 ? p.dark_wood : p.pale_wood, -1));
    parts.push_back(builder.cut(
        make_box({x + 0.4F * door, -depth - 0.03F, 0.6F * height_m}, {0.015F, 0.03F, 0.12F}),
        p.steel, -1));
  }
  return parts;
}

Parts make_plant(SceneBuilder& builder, float height_m) {
  Random random = builder.next_random();
  const Palette& p = builder.palette();
  Parts parts;
  parts.push_back(
      builder.cut(make_lathe({{0.10F, 0.0F}, {0.15F, 0.22F}, {0.16F, 0.25F}, {0.13F, 0.25F}}, 18),
                  p.leather, -1));
  std::vector<Mesh> leaves;
  for (int i = 0; i < 46; ++i) {
    const float z = random.uniform_f(0.25F, height_m);
    const float reach = 0.12F + 0.3F * random.uniform_f(0.3F, 1.0F) * (1.2F - z / height_m);
    const Mesh leaf = make_ellipsoid({0.5F * reach, 0, 0}, {0.5F * reach, 0.045F, 0.006F}, 8, 6);
    const double down_rad = random.uniform(-0.9, 0.3);
    const double around_rad = random.uniform(0.0, 6.28);
    const SE3 T = shift(0, 0, static_cast<double>(z)) * turn(Eigen::Vector3d::UnitZ(), around_rad) *
                  turn(Eigen::Vector3d::UnitY(), down_rad);
    leaves.push_back(transformed(with_uv(leaf, {0.2F, 0.2F}, {random.uniform_f(0, 1), 0.0F}), T));
  }
  leaves.push_back(make_lathe({{0.015F, 0.2F}, {0.01F, height_m}}, 8));
  parts.push_back(builder.cut(merged(leaves), p.leaf, -1));
  return parts;
}

Parts make_hanging(SceneBuilder& builder, const Canvas& picture, float width_m, float height_m,
                   int object) {
  const int texture = builder.add_texture(picture);
  const float y = -0.004F;
  return {builder.covered(upright(-0.5F * width_m, y, -0.5F * height_m, width_m, height_m), texture,
                          object)};
}

Fan make_fan(SceneBuilder& builder, int object) {
  const Palette& p = builder.palette();
  Fan fan;
  fan.foot.push_back(builder.cut(
      make_lathe({{0.11F, 0.0F}, {0.11F, 0.02F}, {0.03F, 0.03F}, {0.018F, 0.06F}, {0.018F, 0.3F}},
                 20),
      p.white, object));
  const Mesh barrel = make_lathe({{0.03F, -0.01F}, {0.05F, 0.02F}, {0.05F, 0.09F}}, 16);
  const SE3 to_back = turn(Eigen::Vector3d::UnitX(), -0.5 * std::numbers::pi);  // z to +y
  fan.head.push_back(builder.cut(transformed(barrel, to_back), p.white, object));
  std::vector<Mesh> rods;
  for (int i = 0; i < 20; ++i) {  // the rim of the cage
    const double angle = 2.0 * std::numbers::pi * i / 20.0;
    const Mesh rod = make_box({0, 0, 0}, {0.056F, 0.05F, 0.006F});
    rods.push_back(transformed(rod, turn(Eigen::Vector3d::UnitY(), angle) * shift(0, -0.03, 0.17)));
  }
  fan.head.push_back(builder.cut(merged(rods), p.steel, object));
  const int paint = builder.add_texture(
      paint_cloth(builder.next_random(), 64, 3.0F * builder.texel_m(), Cloth::blocks),
      Wrap::repeat);
  for (int blade = 0; blade < 4; ++blade) {
    const Mesh sheet = make_box({0, 0, 0.095F}, {0.09F, 0.004F, 0.13F});
    const SE3 T = turn(Eigen::Vector3d::UnitY(), 0.5 * std::numbers::pi * blade) *
                  shift(0, -0.03, 0) * turn(Eigen::Vector3d::UnitZ(), 0.4);
    fan.rotor.push_back(builder.cut(transformed(sheet, T), paint, object));
  }
  fan.rotor.push_back(
      builder.cut(make_ellipsoid({0, -0.04F, 0}, {0.035F, 0.02F, 0.035F}, 12, 8), p.black, object));
  return fan;
}

}  // namespace ydd::sim
