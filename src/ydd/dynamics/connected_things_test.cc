// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/connected_things.h"

#include <gtest/gtest.h>

#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::PaintedScene;

const ConnectedObjectOptions kConnected;
constexpr Box kBodyBox{200, 100, 300, 480};
const std::vector<MovingRegion> kBodies = {{7, Rule::body_depth, kBodyBox, DepthRange{1.0F, 2.0F}}};

TEST(CellReading, TheCentreElseACorner) {
  PaintedScene scene(4.0F);
  scene.paint({0, 0, 4, 4}, 0.0F).paint({1, 1, 2, 2}, 1.5F).paint({4, 0, 8, 4}, 0.0F);
  const DepthImage depth = scene.depth();
  EXPECT_EQ(cell_reading(depth, 0, 0, 4), 1.5F);
  EXPECT_EQ(cell_reading(depth, 4, 0, 4), 0.0F);
  EXPECT_EQ(cell_reading(depth, 8, 0, 4), 4.0F);
  EXPECT_EQ(cell_reading(depth, 639, 479, 1), 4.0F);
}

TEST(Continuous, AStepIsAShareOfTheDepth) {
  EXPECT_TRUE(continuous(1.0F, 1.02F, 0.03));
  EXPECT_FALSE(continuous(1.0F, 1.04F, 0.03));
  EXPECT_TRUE(continuous(4.0F, 4.1F, 0.03));
  EXPECT_FALSE(continuous(0.0F, 0.0F, 0.03));
}

TEST(ConnectedThings, AHeldBookSticksOutOfTheBox) {
  const DepthImage depth =
      PaintedScene().paint(kBodyBox, 1.5F).paint({300, 200, 360, 280}, 1.48F).depth();
  const auto things = connected_things(depth, kBodies, kConnected);
  ASSERT_EQ(things.size(), 1U);
  EXPECT_EQ(things[0].rule, Rule::connected);
  EXPECT_EQ(things[0].object, 7);
  EXPECT_EQ(things[0].box, (Box{300, 200, 360, 280}));
  EXPECT_TRUE(things[0].range->contains(1.48F));
  EXPECT_FALSE(things[0].range->contains(4.0F));
}

TEST(ConnectedThings, AnythingSticksOutOfAnySide) {
  const Box box{200, 100, 300, 400};
  const std::vector<MovingRegion> bodies = {{7, Rule::body_depth, box, DepthRange{1.0F, 2.0F}}};
  const Box sides[] = {
      {300, 200, 340, 280}, {160, 200, 200, 280}, {220, 60, 280, 100}, {220, 400, 280, 440}};
  for (const Box& side : sides) {
    const DepthImage depth = PaintedScene().paint(box, 1.5F).paint(side, 1.48F).depth();
    const auto things = connected_things(depth, bodies, kConnected);
    ASSERT_EQ(things.size(), 1U) << side.x0 << " " << side.y0;
    EXPECT_EQ(things[0].box, side);
  }
}

TEST(ConnectedThings, AWallOrADeskGoesOn) {
  const DepthImage depth =
      PaintedScene().paint(kBodyBox, 1.5F).paint({300, 200, 640, 280}, 1.5F).depth();
  EXPECT_TRUE(connected_things(depth, kBodies, kConnected).empty());
}

TEST(ConnectedThings, AFloorLeavesTheRangeButDoesNotEnd) {
  PaintedScene scene;
  scene.paint(kBodyBox, 1.5F);
  for (int i = 0; i < 60; ++i) {  // rises from 1.96 m beyond the range's end at 2 m
    const auto x = static_cast<float>(300 + 4 * i);
    scene.paint({x, 400, x + 4, 480}, 1.5F + 0.02F * static_cast<float>(i));
  }
  EXPECT_TRUE(connected_things(scene.depth(), kBodies, kConnected).empty());
}

TEST(ConnectedThings, WhatStandsBehindOrApartIsNotConnected) {
  PaintedScene scene;
  scene.paint(kBodyBox, 1.5F).paint({300, 200, 360, 280}, 1.9F).paint({320, 100, 360, 140}, 1.5F);
  EXPECT_TRUE(connected_things(scene.depth(), kBodies, kConnected).empty());
}

TEST(ConnectedThings, ASurfaceBetweenTwoBodiesIsNotHeldByOne) {
  std::vector<MovingRegion> bodies = kBodies;
  bodies.push_back({8, Rule::body_depth, {360, 100, 460, 480}, DepthRange{1.0F, 2.0F}});
  const DepthImage depth = PaintedScene().paint({200, 200, 460, 280}, 1.5F).depth();
  EXPECT_TRUE(connected_things(depth, bodies, kConnected).empty());
}

TEST(ConnectedThings, TheImageBorderEndsASurface) {
  const std::vector<MovingRegion> bodies = {
      {0, Rule::body_depth, {0, 0, 600, 480}, DepthRange{1.0F, 2.0F}}};
  const DepthImage depth = PaintedScene().paint({500, 200, 640, 280}, 1.5F).depth();
  ASSERT_EQ(connected_things(depth, bodies, kConnected).size(), 1U);
}

TEST(ConnectedThings, SpecksDoNotCount) {
  const DepthImage depth =
      PaintedScene().paint(kBodyBox, 1.5F).paint({300, 200, 308, 204}, 1.5F).depth();
  EXPECT_TRUE(connected_things(depth, kBodies, kConnected).empty());
}

TEST(ConnectedThings, NoneForFullRejectionsAndBoxesOutside) {
  const DepthImage depth = PaintedScene(1.5F).depth();
  const std::vector<MovingRegion> bodies = {
      {0, Rule::full_entangled, kBodyBox, std::nullopt},
      {1, Rule::body_depth, {-100, -100, -50, -50}, DepthRange{1.0F, 2.0F}}};
  EXPECT_TRUE(connected_things(depth, bodies, kConnected).empty());
  EXPECT_TRUE(connected_things(depth, {}, kConnected).empty());
}

}  // namespace
}  // namespace ydd
