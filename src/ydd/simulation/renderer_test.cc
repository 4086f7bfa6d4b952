// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/renderer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "ydd/simulation/camera_path.h"
#include "ydd/simulation/scene_builder.h"

namespace ydd::sim {
namespace {

/// A wall at y = 2 with dark dots on white, one every 0.25 m, seen under even light.
constexpr int kDots = 8;
constexpr float kWall_m = 2.0F;

Scene dotted_wall() {
  constexpr int kTexels = 1600;
  Canvas canvas(kTexels, kTexels, grey(0.9F));
  for (int v = 0; v < kDots; ++v) {
    for (int u = 0; u < kDots; ++u) {
      // Texel centres are at + 0.5 of their index, shapes are painted around indices.
      constexpr int kCell = kTexels / kDots;
      const Vector2 at(static_cast<float>(u * kCell + kCell / 2) - 0.5F,
                       static_cast<float>(v * kCell + kCell / 2) - 0.5F);
      canvas.fill_ellipse(at, {14.0F, 14.0F}, 0.0F, grey(0.1F));
    }
  }
  SceneBuilder builder{Random(1), 1.0};
  const Mesh wall = make_panel({-1, 2, 1}, {kWall_m, 0, 0}, {0, 0, -kWall_m}, 5.0F);
  Part part = builder.covered(wall, builder.add_texture(canvas), -1);
  part.glow = 1.0F;
  builder.place({part}, SE3());
  return std::move(builder).finish();
}

Eigen::Vector3d dot(int u, int v) {
  const double cell = static_cast<double>(kWall_m) / kDots;
  return {-1.0 + cell * (u + 0.5), 2.0, 1.0 - cell * (v + 0.5)};
}

TEST(Renderer, TextureLandsWhereTheCameraProjectsIt) {
  const Renderer renderer(dotted_wall());
  const Camera camera = simulated_camera(WorldOptions());
  const SE3 T = look_at({0.13, -0.2, 0.11}, {0.05, 2.0, 0.02}, 0.05);
  const Rendering picture = renderer.render(camera, T, 0.0, {});
  double worst = 0;
  Eigen::Vector2d bias(0, 0);
  int dots = 0;
  for (int v = 1; v + 1 < kDots; ++v) {
    for (int u = 1; u + 1 < kDots; ++u) {
      const Eigen::Vector2d expected = camera.project(T.inverse() * dot(u, v));
      constexpr int kReach = 12;
      const int cx = static_cast<int>(std::lround(expected.x()));
      const int cy = static_cast<int>(std::lround(expected.y()));
      if (cx < kReach || cy < kReach || cx >= 640 - kReach || cy >= 480 - kReach) continue;
      Eigen::Vector2d sum(0, 0);
      double weight = 0;
      for (int y = cy - kReach; y <= cy + kReach; ++y) {
        for (int x = cx - kReach; x <= cx + kReach; ++x) {
          const double dark = 229.0 - static_cast<double>(picture.colours[y * 640 + x][1]);
          if (dark < 2.0) continue;
          sum += dark * Eigen::Vector2d(x, y);
          weight += dark;
        }
      }
      const Eigen::Vector2d error = sum / weight - expected;
      worst = std::max(worst, error.norm());
      bias += error;
      ++dots;
    }
  }
  EXPECT_GT(dots, 15);
  // The geometry is exact; single dots wander a little with the filter's phase.
  EXPECT_LT((bias / dots).norm(), 0.005);
  EXPECT_LT(worst, 0.03);
}

TEST(Renderer, DepthIsAlongTheOpticalAxis) {
  const Renderer renderer(dotted_wall());
  const Camera camera = simulated_camera(WorldOptions());
  const SE3 T = look_at({0.1, -0.3, 0.0}, {0.3, 2.0, 0.2});
  const Rendering picture = renderer.render(camera, T, 0.0, {});
  for (int y = 40; y < 480; y += 97) {
    for (int x = 30; x < 640; x += 89) {
      const float z = picture.pixels[y * 640 + x].depth_m;
      const Eigen::Vector3d p = T * camera.unproject({x, y}, static_cast<double>(z));
      if (z > 0) {
        EXPECT_NEAR(p.y(), 2.0, 2e-6);
      }
    }
  }
}

TEST(Renderer, EdgesCoverTheirShareOfAPixel) {
  // A white square on nothing: the sum of its pixels is its area, wherever it lies.
  SceneBuilder builder{Random(1), 1.0};
  const Mesh square = make_panel({-0.2F, 1, 0.2F}, {0.4F, 0, 0}, {0, 0, -0.4F}, 5.0F);
  Part part = builder.covered(square, builder.add_texture(Canvas(4, 4, grey(1.0F))), -1);
  part.glow = 1.0F;
  builder.place({part}, SE3());
  const Renderer renderer(std::move(builder).finish());
  const Camera camera = simulated_camera(WorldOptions());
  RenderOptions options;
  options.edge_samples = 16;
  const SE3 T = look_at({0.0123, 0, 0.0077}, {0.0123, 1, 0.0077});
  double sum = 0;
  for (const Eigen::Array3f& c : renderer.render(camera, T, 0.0, options).colours) {
    sum += static_cast<double>(c[0]) / 255.0;
  }
  const double area = 0.16 * camera.fx_px * camera.fy_px;
  EXPECT_NEAR(sum / area, 1.0, 1e-3);
}

}  // namespace
}  // namespace ydd::sim
