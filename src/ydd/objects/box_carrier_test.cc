// SPDX-License-Identifier: Apache-2.0
#include "ydd/objects/box_carrier.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

/// A textured thing before a textured wall; its place is a function of the frame.
struct World {
  double speed_px = 6;       ///< of the thing to the right, per frame
  double wall_speed_px = 0;  ///< of everything behind it
  double approach = 1.0;     ///< depth of a frame / depth of the frame before
  double start_x = 150;

  Box box(int frame) const {
    const auto size = static_cast<float>(1.0 / std::pow(approach, frame));
    const auto cx = static_cast<float>(start_x + 60 + speed_px * frame);
    return {cx - 60 * size, 240 - 120 * size, cx + 60 * size, 240 + 120 * size};
  }

  RgbdFrame frame(int index) const {
    std::vector<std::uint8_t> grey;
    std::vector<float> depth_m;
    const Box b = box(index);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool on_thing = b.contains(static_cast<float>(x), static_cast<float>(y));
        const double u = on_thing ? 120.0 * (static_cast<double>(x) - b.x0) / b.width()
                                  : static_cast<double>(x) - wall_speed_px * index + 5000;
        const double v = on_thing ? 240.0 * (static_cast<double>(y) - b.y0) / b.height() + 900 : y;
        grey.push_back(texture(u, v));
        depth_m.push_back(on_thing ? static_cast<float>(1.5 * std::pow(approach, index)) : 3.0F);
      }
    }
    RgbdFrame out;
    out.index = index;
    out.grey = GreyImage(kWidth, kHeight, std::move(grey));
    out.depth_m = DepthImage(kWidth, kHeight, std::move(depth_m));
    return out;
  }

  static std::uint8_t texture(double u, double v) {
    const double t = std::sin(u * 0.21) + std::cos(v * 0.17) + std::sin((u + 2 * v) * 0.09) +
                     std::sin(u * 0.047 - v * 0.031);
    return static_cast<std::uint8_t>(127 + 30 * t);
  }
};

Detections seen(const Box& box, const char* name = "person") { return {{name, 0.9F, box}}; }

void expect_near(const Box& a, const Box& b, double tolerance_px) {
  EXPECT_NEAR(a.x0, b.x0, tolerance_px);
  EXPECT_NEAR(a.y0, b.y0, tolerance_px);
  EXPECT_NEAR(a.x1, b.x1, tolerance_px);
  EXPECT_NEAR(a.y1, b.y1, tolerance_px);
}

TEST(BoxCarrier, ASilhouetteIsNotCarried) {
  const World world;
  BoxCarrier carrier({});
  carrier.advance(world.frame(0));
  Detections found = seen(world.box(0));
  found.front().mask = world.frame(0).grey;
  carrier.take(0, found);
  ASSERT_EQ(carrier.now().size(), 1U);
  EXPECT_TRUE(carrier.now().front().mask.empty());
}

TEST(BoxCarrier, ABoxFollowsWhatIsInItNotWhatIsBehind) {
  const World world{.speed_px = 7, .wall_speed_px = -5};
  BoxCarrier carrier({});
  carrier.advance(world.frame(0));
  carrier.take(0, seen(world.box(0)));
  for (int i = 1; i <= 8; ++i) carrier.advance(world.frame(i));
  ASSERT_EQ(carrier.now().size(), 1U);
  expect_near(carrier.now()[0].box, world.box(8), 6);
}

TEST(BoxCarrier, ABoxGrowsWithWhatComesNearer) {
  const World world{.speed_px = 0, .approach = 0.98};
  BoxCarrier carrier({});
  carrier.advance(world.frame(0));
  carrier.take(0, seen(world.box(0)));
  for (int i = 1; i <= 8; ++i) carrier.advance(world.frame(i));
  ASSERT_EQ(carrier.now().size(), 1U);
  EXPECT_GT(world.box(8).width(), 1.15F * world.box(0).width());
  EXPECT_NEAR(carrier.now()[0].box.width(), world.box(8).width(), 8);
}

TEST(BoxCarrier, AResultForAnEarlierFrameIsBroughtToTheNewest) {
  const World world;
  BoxCarrier carrier({});
  for (int i = 0; i <= 5; ++i) carrier.advance(world.frame(i));
  EXPECT_TRUE(carrier.now().empty());
  carrier.take(1, seen(world.box(1)));
  ASSERT_EQ(carrier.now().size(), 1U);
  expect_near(carrier.now()[0].box, world.box(5), 5);
}

TEST(BoxCarrier, ConstantVelocityComesFromTwoResults) {
  const World world;
  CarryOptions options;
  options.motion = BoxMotion::constant;
  BoxCarrier carrier(options);
  carrier.advance(world.frame(0));
  carrier.take(0, seen(world.box(0)));
  for (int i = 1; i <= 4; ++i) carrier.advance(world.frame(i));
  expect_near(carrier.now()[0].box, world.box(0), 0.01);  // one result: no motion known
  carrier.take(2, seen(world.box(2)));
  expect_near(carrier.now()[0].box, world.box(4), 0.01);
}

TEST(BoxCarrier, APersonSurvivesSomeMissedResultsAThingDoesNot) {
  const World world;
  CarryOptions options;
  options.missed = 2;
  for (const char* name : {"person", "chair"}) {
    BoxCarrier carrier(options);
    int i = 0;
    for (; i < 3; ++i) {
      carrier.advance(world.frame(i));
      carrier.take(i, seen(world.box(i), name));
    }
    std::vector<std::size_t> boxes;
    for (; i < 7; ++i) {
      carrier.advance(world.frame(i));
      carrier.take(i, {});
      boxes.push_back(carrier.now().size());
    }
    if (std::string(name) == "person") {
      EXPECT_EQ(boxes, (std::vector<std::size_t>{1, 1, 0, 0}));
    } else {
      EXPECT_EQ(boxes, (std::vector<std::size_t>{0, 0, 0, 0}));
    }
  }
}

TEST(BoxCarrier, APersonSeenOnceIsNotBelievedWithoutAnother) {
  const World world;
  BoxCarrier carrier({});
  carrier.advance(world.frame(0));
  carrier.take(0, seen(world.box(0)));
  carrier.advance(world.frame(1));
  carrier.take(1, {});
  EXPECT_TRUE(carrier.now().empty());
}

TEST(BoxCarrier, ABoxOnTheBorderStaysThereWhileItsThingComesIn) {
  const World world{.speed_px = 10, .start_x = -60};
  BoxCarrier carrier({});
  carrier.advance(world.frame(0));
  carrier.take(0, seen({0, 120, 60, 360}));
  for (int i = 1; i <= 4; ++i) carrier.advance(world.frame(i));
  ASSERT_EQ(carrier.now().size(), 1U);
  EXPECT_EQ(carrier.now()[0].box.x0, 0);
  EXPECT_NEAR(carrier.now()[0].box.x1, 100, 6);
}

TEST(BoxCarrier, FramesComeInOrderAndTheSameCallsGiveTheSameBoxes) {
  const World world;
  const auto run = [&] {
    BoxCarrier carrier({});
    for (int i = 0; i <= 4; ++i) carrier.advance(world.frame(i));
    carrier.take(2, seen(world.box(2)));
    return carrier.now()[0].box;
  };
  EXPECT_EQ(run(), run());
  BoxCarrier carrier({});
  carrier.advance(world.frame(3));
  EXPECT_THROW(carrier.advance(world.frame(3)), std::logic_error);
}

}  // namespace
}  // namespace ydd
