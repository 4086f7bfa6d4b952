// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/movers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "ydd/detection/object_catalogue.h"
#include "ydd/simulation/simulator.h"
#include "ydd/simulation/visitors.h"

namespace ydd {
namespace {

WorldOptions ten_a_second(int frames) {
  WorldOptions options;
  options.width_px = 320;
  options.height_px = 240;
  options.fps = 10.0;
  options.frames = frames;
  return options;
}

CameraPath standing_still() {
  return [](double) { return look_at(kCameraPlace_m, {2.75, 4.6, 1.12}); };
}

template <class T>
bool equal_pixels(const Image<T>& a, const Image<T>& b) {
  return std::equal(a.data(), a.data() + std::size_t(a.width()) * a.height(), b.data());
}

double masked_share(const SimulatedFrame& frame) {
  const std::size_t pixels = std::size_t(frame.mask.width()) * frame.mask.height();
  const auto still = std::count(frame.mask.data(), frame.mask.data() + pixels, 0);
  return 1.0 - static_cast<double>(still) / static_cast<double>(pixels);
}

const SimulatedObject* find_object(const SimulatedFrame& frame, const std::string& name) {
  const auto found = std::find_if(frame.objects.begin(), frame.objects.end(),
                                  [&](const SimulatedObject& o) { return o.name == name; });
  return found == frame.objects.end() ? nullptr : &*found;
}

/// Corners on what moves and on what does not.
std::array<int, 2> corners_on_and_off(const SimulatedFrame& frame) {
  const GreyImage& grey = frame.frame.grey;
  cv::Mat image(grey.height(), grey.width(), CV_8UC1);
  std::copy_n(grey.data(), image.total(), image.data);
  std::vector<cv::Point2f> found;
  cv::goodFeaturesToTrack(image, found, 4000, 0.002, 3);
  std::array<int, 2> count = {0, 0};
  for (const cv::Point2f& p : found) {
    ++count[frame.mask(static_cast<int>(p.x), static_cast<int>(p.y)) != 0 ? 0 : 1];
  }
  return count;
}

class Movers : public testing::TestWithParam<MoverKind> {};

TEST_P(Movers, HoldAThirdOfTheViewBeforeARoomFullOfCorners) {
  WorldOptions options = ten_a_second(50);
  options.mover = GetParam();
  const Simulator simulator(options);
  EXPECT_FALSE(ObjectCatalogue::defaults().knows("thing"));
  double share = 0;
  constexpr int kLooks = 10;
  for (int k = 0; k < kLooks; ++k) {
    const SimulatedFrame frame = simulator.render(5 * k);
    share += masked_share(frame) / kLooks;
    EXPECT_GT(masked_share(frame), 0.15);
    EXPECT_LT(masked_share(frame), 0.65);
    int things = 0;
    for (const SimulatedObject& object : frame.objects) {
      EXPECT_NE(object.class_name, "person");
      EXPECT_EQ(object.moved_in_sequence, object.class_name == "thing") << object.name;
      if (object.class_name != "thing") continue;
      ++things;
      EXPECT_GE(object.id, 1);
      EXPECT_LE(object.id, 255);
      EXPECT_NEAR(object.pixels, masked_share(frame) * 320 * 240, 0.5);
    }
    EXPECT_EQ(things, 1);
    const auto [on, off] = corners_on_and_off(frame);
    EXPECT_GT(on, 150);
    EXPECT_GT(off, 300);
  }
  EXPECT_GT(share, 0.28);
  EXPECT_LT(share, 0.45);
}

TEST_P(Movers, MoveMostOfTheTime) {
  WorldOptions options = ten_a_second(50);
  options.mover = GetParam();
  options.width_px = 64;
  options.height_px = 48;
  const Simulator simulator(options);
  int moves = 0;
  for (int i = 0; i < 50; ++i) {
    const SimulatedFrame frame = simulator.render(i);
    moves += std::any_of(frame.objects.begin(), frame.objects.end(),
                         [](const SimulatedObject& o) { return o.dynamic; })
                 ? 1
                 : 0;
  }
  EXPECT_GE(moves, 45);
}

INSTANTIATE_TEST_SUITE_P(All, Movers,
                         testing::Values(MoverKind::cabinet, MoverKind::curtain, MoverKind::door,
                                         MoverKind::robot, MoverKind::screen),
                         [](const auto& kind) {
                           return std::string(
                               choices_of(MoverKind{})[static_cast<std::size_t>(kind.param)]);
                         });

TEST(ScrollingScreen, ShowsAnotherPictureAtTheSamePlace) {
  WorldOptions options = ten_a_second(50);
  options.mover = MoverKind::screen;
  const Simulator simulator(options, standing_still());
  const SimulatedFrame a = simulator.render(0);
  for (const int i : {1, 7, 33}) {
    const SimulatedFrame b = simulator.render(i);
    EXPECT_TRUE(equal_pixels(a.mask, b.mask)) << i;  // no gap between the strips
    int differ = 0;
    double depth_off_m = 0;
    for (int k = 0; k < 320 * 240; ++k) {
      if (a.mask.data()[k] == 0) continue;
      differ += std::abs(a.frame.grey.data()[k] - b.frame.grey.data()[k]) > 12 ? 1 : 0;
      depth_off_m = std::max(depth_off_m, static_cast<double>(std::abs(a.frame.depth_m.data()[k] -
                                                                       b.frame.depth_m.data()[k])));
    }
    EXPECT_GT(differ, 0.4 * masked_share(a) * 320 * 240) << i;
    EXPECT_LT(depth_off_m, 1e-5);
  }
}

TEST(FrozenWorld, StandsAsAtThatSecondAndCountsAsStill) {
  WorldOptions options = ten_a_second(40);
  options.people = 3;
  options.mover = MoverKind::robot;
  const Simulator moving(options, standing_still());
  options.frozen_at_s = 1.0;
  const Simulator frozen(options, standing_still());
  const SimulatedFrame as_it_was = moving.render(10);
  EXPECT_TRUE(equal_pixels(frozen.render(10).frame.colour, as_it_was.frame.colour));
  int statues = 0;
  for (const int i : {0, 10, 39}) {
    const SimulatedFrame frame = frozen.render(i);
    EXPECT_TRUE(equal_pixels(frame.frame.depth_m, as_it_was.frame.depth_m)) << i;
    EXPECT_EQ(masked_share(frame), 0.0);
    for (const SimulatedObject& object : frame.objects) {
      EXPECT_FALSE(object.dynamic) << object.name;
      EXPECT_FALSE(object.moved_in_sequence) << object.name;
      statues += object.class_name == "person" || object.class_name == "thing" ? 1 : 0;
    }
  }
  EXPECT_GE(statues, 6);
}

TEST(Visitors, OneLeavesForGoodAndOneComesToStay) {
  WorldOptions options = ten_a_second(140);
  options.sit_then_leave = options.come_and_stay = true;
  const Simulator simulator(options);
  const auto at_s = [&](double s) {
    return simulator.render(static_cast<int>(std::lround(10 * s)));
  };
  for (const double s : {0.0, 1.5, 2.9}) {
    const SimulatedFrame frame = at_s(s);
    const SimulatedObject* leaver = find_object(frame, "person0");
    ASSERT_NE(leaver, nullptr) << s;
    EXPECT_FALSE(leaver->dynamic) << s;
    EXPECT_GT(leaver->pixels, 5000) << s;
  }
  const SimulatedFrame on_the_way = at_s(sim::kLeaverStands_s + 0.5);
  ASSERT_NE(find_object(on_the_way, "person0"), nullptr);
  EXPECT_TRUE(find_object(on_the_way, "person0")->dynamic);
  EXPECT_EQ(find_object(at_s(0.0), "person1"), nullptr);
  const SimulatedFrame coming = at_s(sim::kComerArrives_s - 0.5);
  ASSERT_NE(find_object(coming, "person1"), nullptr);
  EXPECT_TRUE(find_object(coming, "person1")->dynamic);
  for (const double s : {sim::kComerArrives_s + 0.2, 6.0, 9.0, 13.9}) {
    const SimulatedFrame frame = at_s(s);
    const SimulatedObject* comer = find_object(frame, "person1");
    ASSERT_NE(comer, nullptr) << s;
    EXPECT_FALSE(comer->dynamic) << s;
    EXPECT_TRUE(comer->moved_in_sequence) << s;
    if (s > 5.5) {
      EXPECT_EQ(find_object(frame, "person0"), nullptr) << s;
    }
  }
}

/// Share of pixels whose depth is the other image's `right_px` further to the left.
double share_shifted(const DepthImage& depth, const DepthImage& other, int right_px) {
  int agree = 0;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = right_px; x < depth.width(); ++x) {
      agree += std::abs(depth(x, y) - other(x - right_px, y)) < 1e-4F ? 1 : 0;
    }
  }
  return static_cast<double>(agree) / ((depth.width() - right_px) * depth.height());
}

TEST(DepthSensorAstray, LiesToTheRightOfColour) {
  WorldOptions options = ten_a_second(20);
  options.people = 2;
  const SimulatedFrame straight = Simulator(options).render(12);
  options.registration_off_px = 10.0;  // 5 at this width
  const SimulatedFrame off = Simulator(options).render(12);
  EXPECT_TRUE(equal_pixels(off.frame.colour, straight.frame.colour));
  EXPECT_TRUE(equal_pixels(off.mask, straight.mask));
  EXPECT_EQ(off.objects.size(), straight.objects.size());
  EXPECT_GT(share_shifted(off.frame.depth_m, straight.frame.depth_m, 5), 0.99);
  EXPECT_LT(share_shifted(off.frame.depth_m, straight.frame.depth_m, 0), 0.5);
}

TEST(DepthSensorAstray, ShowsTheWorldAsItWas) {
  WorldOptions options = ten_a_second(20);
  options.people = 2;
  const Simulator punctual(options);
  options.depth_late_ms = 100.0;  // a frame
  const Simulator late(options);
  const SimulatedFrame now = late.render(12);
  const SimulatedFrame then = punctual.render(11);
  EXPECT_GT(share_shifted(now.frame.depth_m, then.frame.depth_m, 0), 0.99);
  EXPECT_LT(share_shifted(now.frame.depth_m, punctual.render(12).frame.depth_m, 0), 0.5);
  EXPECT_TRUE(equal_pixels(now.frame.colour, punctual.render(12).frame.colour));
  EXPECT_TRUE(equal_pixels(now.mask, punctual.render(12).mask));
  EXPECT_EQ(now.T_world_camera.translation(), punctual.pose(12).translation());
  EXPECT_NO_THROW(late.render(0));  // the path goes on before the first frame
}

}  // namespace
}  // namespace ydd
