// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/hidden_bodies.h"

#include <gtest/gtest.h>

#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::PaintedScene;

constexpr Box kFront{200, 100, 320, 480};
constexpr Box kBehind{220, 60, 360, 480};
const std::vector<MovingRegion> kOthers = {{0, Rule::body_depth, kFront, DepthRange{0.8F, 1.8F}}};

DepthImage one_hides_the_other() {
  return PaintedScene().paint(kBehind, 2.2F).paint(kFront, 1.0F).depth();
}

std::vector<MovingRegion> regions(std::optional<DepthRange> front) {
  return {{0, Rule::body_depth, kFront, front}, {1, Rule::full_entangled, kBehind, std::nullopt}};
}
const DepthRange kFrontRange{0.8F, 1.8F};

TEST(UnexplainedDepth, IsThatOfTheHiddenPerson) {
  const auto depth = unexplained_depth(one_hides_the_other(), 1, regions(kFrontRange), 0.05);
  EXPECT_FLOAT_EQ(depth.value(), 2.2F);
}

TEST(UnexplainedDepth, OfThePersonInFrontIsItsOwn) {
  std::vector<MovingRegion> both = regions(kFrontRange);
  both[1].range = DepthRange{2.0F, 3.2F};
  EXPECT_FLOAT_EQ(unexplained_depth(one_hides_the_other(), 0, both, 0.05).value(), 1.0F);
}

TEST(UnexplainedDepth, FullRejectionsExplainNothing) {
  const auto depth = unexplained_depth(one_hides_the_other(), 1, regions(std::nullopt), 0.05);
  EXPECT_FLOAT_EQ(depth.value(), 1.0F);
}

TEST(UnexplainedDepth, NothingWhenTooLittleIsLeft) {
  const DepthImage depth = PaintedScene(0.0F).paint(kFront, 1.0F).depth();
  EXPECT_FALSE(unexplained_depth(depth, 1, regions(kFrontRange), 0.05));
  EXPECT_FALSE(unexplained_depth(depth, 1, regions(kFrontRange), 0.0));
  EXPECT_FALSE(unexplained_depth(PaintedScene(0.0F).depth(), 0, regions(kFrontRange), 0.0));
}

TEST(UnexplainedDepth, AFewNearReadingsDoNotDecide) {
  PaintedScene scene;
  scene.paint(kBehind, 2.2F).paint(kFront, 1.0F).paint({330, 100, 340, 110}, 0.5F);
  EXPECT_FLOAT_EQ(unexplained_depth(scene.depth(), 1, regions(kFrontRange), 0.05).value(), 2.2F);
}

}  // namespace
}  // namespace ydd
