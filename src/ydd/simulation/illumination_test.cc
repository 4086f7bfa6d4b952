// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/illumination.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ydd/simulation/simulator.h"

namespace ydd {
namespace {

WorldOptions lit_world(LightKind light, int light_seed = 1) {
  WorldOptions options;
  options.seed = 7;
  options.width_px = 96;
  options.height_px = 72;
  options.edge_samples = 1;
  options.pixel_noise = 0;
  options.texture_detail = 0.3;
  options.frames = 400;
  options.light = light;
  options.light_seed = light_seed;
  return options;
}

ColourImage picture_of(const WorldOptions& options, int index = 0) {
  return Simulator(options).render(index).frame.colour;
}

/// Mean over the picture of the largest difference of a channel.
double difference(const ColourImage& a, const ColourImage& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      int most = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        most = std::max(most, std::abs(int{a(x, y)[k]} - int{b(x, y)[k]}));
      }
      sum += most;
    }
  }
  return sum / (a.width() * a.height());
}

TEST(Light, SteadyLightKnowsNoSeedOfLight) {
  const ColourImage before = picture_of(lit_world(LightKind::steady, 1));
  EXPECT_EQ(difference(before, picture_of(lit_world(LightKind::steady, 2))), 0);
}

TEST(Light, EachHourLooksDifferentAndIsTheSameAgain) {
  std::vector<ColourImage> pictures;
  for (const LightKind light :
       {LightKind::steady, LightKind::day, LightKind::evening, LightKind::lamps}) {
    pictures.push_back(picture_of(lit_world(light)));
  }
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GT(difference(pictures[i], pictures[k]), 8.0) << i << " " << k;
    }
  }
  EXPECT_EQ(difference(pictures[1], picture_of(lit_world(LightKind::day))), 0);
  EXPECT_GT(difference(pictures[1], picture_of(lit_world(LightKind::day, 2))), 1.0);
}

TEST(Light, WhereThingsStandDoesNotDependOnIt) {
  const SimulatedFrame day = Simulator(lit_world(LightKind::day)).render(3);
  const SimulatedFrame steady = Simulator(lit_world(LightKind::steady)).render(3);
  for (int y = 0; y < day.frame.depth_m.height(); ++y) {
    for (int x = 0; x < day.frame.depth_m.width(); ++x) {
      ASSERT_EQ(day.frame.depth_m(x, y), steady.frame.depth_m(x, y)) << x << " " << y;
    }
  }
  EXPECT_EQ((day.T_world_camera.translation() - steady.T_world_camera.translation()).norm(), 0);
}

TEST(Light, ChangingLightGoesOnSmoothly) {
  WorldOptions options = lit_world(LightKind::changing);
  options.light_change_s = 4.0;
  options.path = PathKind::stationary;
  const auto changes = sim::make_light_changes(options);
  ASSERT_TRUE(changes.has_value());
  double largest_step = 0, range = 0;
  sim::LightNow before = changes->at(0);
  const sim::LightNow first = before;
  for (double t = 0.02; t < 13.0; t += 0.02) {
    const sim::LightNow now = changes->at(t);
    for (std::size_t i = 0; i < now.sources.size(); ++i) {
      largest_step =
          std::max(largest_step, double{(now.sources[i] - before.sources[i]).abs().maxCoeff()});
      range = std::max(range, double{(now.sources[i] - first.sources[i]).abs().maxCoeff()});
    }
    before = now;
  }
  EXPECT_GT(range, 0.5);
  EXPECT_LT(largest_step, 0.1);
}

TEST(Light, WarmIsYellowAndColdIsBlue) {
  const Eigen::Array3f warm = sim::colour_of_temperature(2700);
  const Eigen::Array3f cold = sim::colour_of_temperature(8000);
  EXPECT_LT(warm[0], 0.7F);
  EXPECT_GT(warm[2], 1.2F);
  EXPECT_GT(cold[0], 1.1F);
  EXPECT_LT(cold[2], 0.95F);
  EXPECT_LT((sim::colour_of_temperature(5500) - 1.0F).abs().maxCoeff(), 1e-4F);
}

TEST(Light, TheCameraBrightensTheDarkWithinLimits) {
  const std::vector<Eigen::Array3f> dark(10, Eigen::Array3f(20, 20, 20));
  const std::vector<Eigen::Array3f> night(10, Eigen::Array3f(0.1F, 0.1F, 0.1F));
  const std::vector<Eigen::Array3f> yellow(10, Eigen::Array3f(50, 100, 150));
  EXPECT_GT(sim::automatic_gain(dark, 1.0)[1], 3.0F);
  EXPECT_LE(sim::automatic_gain(night, 1.0)[1], 4.0F);
  EXPECT_GT(sim::automatic_gain(yellow, 1.0)[0], sim::automatic_gain(yellow, 1.0)[2]);
}

}  // namespace
}  // namespace ydd
