// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/texture.h"

#include <gtest/gtest.h>

#include "ydd/simulation/mesh.h"

namespace ydd::sim {
namespace {

Canvas ramp(int side) {
  Canvas canvas(side, side, grey(0));
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      canvas.at(x, y) = grey(static_cast<float>(x) / static_cast<float>(side));
    }
  }
  return canvas;
}

TEST(Texture, InterpolatesBetweenTexelCentres) {
  const Texture texture(ramp(64), Wrap::clamp);
  const Footprint tiny{{0.1F, 0}, {0, 0.1F}};
  EXPECT_NEAR(texture.sample(10.5F, 7.5F, tiny)[0], 10.0F / 64 * 255, 0.51F);
  EXPECT_NEAR(texture.sample(11.0F, 7.5F, tiny)[1], 10.5F / 64 * 255, 0.51F);
  EXPECT_NEAR(texture.sample(-5.0F, 7.5F, tiny)[0], 0.0F, 0.51F);
  EXPECT_NEAR(texture.sample(99.0F, 7.5F, tiny)[0], 63.0F / 64 * 255, 0.51F);
}

TEST(Texture, KeepsTheMeanWhateverTheFootprint) {
  Random random(3);
  Canvas canvas(256, 256, grey(0.5F));
  canvas.add_noise(random, 1.0F, grey(0.4F));
  const Texture texture(canvas, Wrap::repeat);
  const Footprint wide{{64.0F, 0}, {0, 64.0F}};
  const Footprint oblique{{40.0F, 0}, {0, 4.0F}};
  EXPECT_NEAR(texture.sample(128, 128, wide)[0], 127.5F, 6.0F);
  EXPECT_NEAR(texture.sample(90, 40, oblique)[0], 127.5F, 25.0F);
}

TEST(Texture, RepeatsOnlyPowersOfTwo) {
  EXPECT_THROW(Texture(Canvas(48, 64, grey(0)), Wrap::repeat), std::logic_error);
  const Texture texture(ramp(64), Wrap::repeat);
  const Footprint tiny{{0.1F, 0}, {0, 0.1F}};
  EXPECT_NEAR(texture.sample(10.2F, 5, tiny)[0], texture.sample(74.2F, 5, tiny)[0], 1e-3);
}

TEST(Canvas, ShapesCoverTheirArea) {
  Canvas canvas(100, 100, grey(0));
  canvas.fill_ellipse({50, 50}, {20, 20}, 0.0F, grey(1));
  float sum = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) sum += canvas.at(x, y)[0];
  }
  EXPECT_NEAR(sum, 3.14159F * 400, 10);
}

TEST(Mesh, NormalsPointOutwards) {
  const std::vector<Mesh> bodies = {make_box({0, 0, 0}, {1, 2, 3}),
                                    make_ellipsoid({0, 0, 0}, {1, 2, 3}, 12, 8),
                                    make_lathe({{1, -1}, {1.5F, 0}, {1, 1}}, 12)};
  for (const Mesh& mesh : bodies) {
    ASSERT_EQ(mesh.positions.size(), mesh.normals.size());
    ASSERT_EQ(mesh.positions.size(), mesh.uvs.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      EXPECT_GT(mesh.positions[i].dot(mesh.normals[i]), 0);
      EXPECT_NEAR(mesh.normals[i].norm(), 1, 1e-5);
    }
  }
}

TEST(Random, IsUniformAndNormal) {
  Random random(5);
  double sum = 0;
  double sum2 = 0;
  double quick2 = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    sum += random.uniform();
    const double n = random.normal();
    sum2 += n * n;
    const double q = static_cast<double>(quick_normal(random.bits()));
    quick2 += q * q;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.005);
  EXPECT_NEAR(sum2 / kCount, 1.0, 0.02);
  EXPECT_NEAR(quick2 / kCount, 1.0, 0.02);
}

}  // namespace
}  // namespace ydd::sim
