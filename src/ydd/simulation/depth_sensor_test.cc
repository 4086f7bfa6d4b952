// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/depth_sensor.h"

#include <cmath>

#include <gtest/gtest.h>

#include "ydd/simulation/world_options.h"

namespace ydd::sim {
namespace {

Camera kinect() {
  WorldOptions options;
  options.depth = DepthModel::kinect;
  return simulated_camera(options);
}

Rendering wall(double depth_m) {
  RenderedPixel pixel;
  pixel.depth_m = static_cast<float>(depth_m);
  return {{}, std::vector<RenderedPixel>(640 * 480, pixel)};
}

struct Moments {
  double mean = 0;
  double deviation = 0;
  int holes = 0;
};

Moments moments(const DepthImage& depth) {
  Moments m;
  double sum = 0;
  double sum2 = 0;
  int count = 0;
  for (int i = 0; i < 640 * 480; ++i) {
    const double z = static_cast<double>(depth.data()[i]);
    if (z <= 0) {
      ++m.holes;
      continue;
    }
    sum += z;
    sum2 += z * z;
    ++count;
  }
  m.mean = sum / count;
  m.deviation = std::sqrt(sum2 / count - m.mean * m.mean);
  return m;
}

class KinectNoise : public testing::TestWithParam<double> {};

TEST_P(KinectNoise, IsThatOfTheModel) {
  const double z = GetParam();
  const Camera camera = kinect();
  const Moments m = moments(kinect_depth(wall(z), camera, 7));
  const double step = z * z / (8.0 * camera.fx_px * 0.075);  // 1/8 px of disparity
  const double noise = kinect_noise_m(z);
  EXPECT_DOUBLE_EQ(noise, 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4));
  // Rounding adds the variance of a uniform step as long as the noise is not small beside it.
  const double expected = std::sqrt(noise * noise + step * step / 12.0);
  EXPECT_NEAR(m.deviation / expected, 1.0, noise > 0.4 * step ? 0.05 : 0.5);
  EXPECT_NEAR(m.mean, z, 0.15 * step + 0.02 * noise);
  EXPECT_EQ(m.holes, 0);
}

INSTANTIATE_TEST_SUITE_P(Depths, KinectNoise, testing::Values(0.8, 1.2, 2.0, 3.0, 4.0));

TEST(KinectDepth, ComesInStepsOfDisparity) {
  const Camera camera = kinect();
  const DepthImage depth = kinect_depth(wall(2.3), camera, 3);
  for (int i = 0; i < 640; ++i) {
    const double steps = camera.fx_px * 0.075 / static_cast<double>(depth(i, 100)) * 8.0;
    EXPECT_NEAR(steps, std::round(steps), 1e-3);
  }
}

TEST(KinectDepth, FollowsItsSeed) {
  const Camera camera = kinect();
  const DepthImage a = kinect_depth(wall(2.0), camera, 1);
  const DepthImage b = kinect_depth(wall(2.0), camera, 1);
  const DepthImage c = kinect_depth(wall(2.0), camera, 2);
  EXPECT_TRUE(std::equal(a.data(), a.data() + 640 * 480, b.data()));
  EXPECT_FALSE(std::equal(a.data(), a.data() + 640 * 480, c.data()));
}

TEST(KinectDepth, HasNoReadingOutOfRangeInShadowAndAtGrazingAngles) {
  const Camera camera = kinect();
  EXPECT_EQ(moments(kinect_depth(wall(0.45), camera, 1)).holes, 640 * 480);
  EXPECT_EQ(moments(kinect_depth(wall(4.9), camera, 1)).holes, 640 * 480);
  Rendering shadow = wall(2.0);
  for (RenderedPixel& pixel : shadow.pixels) pixel.lit_by_projector = false;
  EXPECT_EQ(moments(kinect_depth(shadow, camera, 1)).holes, 640 * 480);
  Rendering grazing = wall(2.0);
  for (RenderedPixel& pixel : grazing.pixels) pixel.facing = 0.05F;
  EXPECT_EQ(moments(kinect_depth(grazing, camera, 1)).holes, 640 * 480);
}

TEST(KinectDepth, SilhouettesAreRaggedAndNothingElseIs) {
  Rendering step = wall(3.0);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 320; ++x) step.pixels[y * 640 + x].depth_m = 1.0F;
  }
  const DepthImage depth = kinect_depth(step, kinect(), 5);
  int strayed = 0;
  int holes = 0;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const bool near = depth(x, y) < 2.0F;
      if (depth(x, y) <= 0) {
        ++holes;
      } else if (near != (x < 320)) {
        ++strayed;
      } else {
        continue;
      }
      EXPECT_LE(std::abs(x - 319), 3);
    }
  }
  EXPECT_GT(strayed, 100);
  EXPECT_GT(holes, 30);
}

TEST(ExactDepth, IsExactWithinTheLimits) {
  Camera camera = kinect();
  EXPECT_EQ(exact_depth(wall(2.345), camera)(5, 5), 2.345F);
  EXPECT_EQ(exact_depth(wall(5.0), camera)(5, 5), 0.0F);
}

}  // namespace
}  // namespace ydd::sim
