// SPDX-License-Identifier: Apache-2.0
// What must hold of the point decisions in any simulated room, whatever its seed.
#include <gtest/gtest.h>

#include "ydd/dynamics/judge.h"
#include "ydd/features/orb_extractor.h"
#include "ydd/simulation/simulator.h"
#include "ydd/studies/point_quality.h"

namespace ydd {
namespace {

Detections exact_boxes(const SimulatedFrame& frame) {
  Detections detections;
  for (const SimulatedObject& o : frame.objects) detections.push_back({o.class_name, 1.0F, o.box});
  return detections;
}

std::vector<Box> person_boxes(const Detections& detections) {
  std::vector<Box> boxes;
  for (const Detection& d : detections) {
    if (d.class_name == "person") boxes.push_back(d.box);
  }
  return boxes;
}

constexpr int kEvery = 20;

/// Quality over every twentieth frame of a room.
PointQuality measure(const WorldOptions& world, Variant variant) {
  const Simulator simulator(world);
  DynamicsOptions options;
  options.variant = variant;
  DynamicsJudge judge(options, ObjectCatalogue::defaults());
  OrbExtractor extractor{OrbOptions()};
  PointQuality quality;
  for (int i = 0; i < simulator.frame_count(); i += kEvery) {
    const SimulatedFrame frame = simulator.render(i);
    const Features features = with_geometry(extractor.extract(frame.frame.grey, judge.budget()),
                                            simulator.camera(), frame.frame.depth_m);
    const Detections detections = exact_boxes(frame);
    const Judgement judgement = judge.judge(features, detections, frame.frame.depth_m);
    quality +=
        point_quality(judgement.rules, features.keypoints, frame.mask, person_boxes(detections));
  }
  return quality;
}

WorldOptions busy_room(int seed) {
  WorldOptions world;
  world.busy = true;
  world.seed = seed;
  world.frames = 84;
  world.depth = DepthModel::kinect;
  world.threads = 1;
  return world;
}

class BusyRoom : public ::testing::TestWithParam<int> {};

TEST_P(BusyRoom, FullFindsWhatMovesAndKeepsTheRoom) {
  const PointQuality full = measure(busy_room(GetParam()), Variant::full);
  ASSERT_GT(full.moving, 500);
  EXPECT_GE(full.recall(), 0.97);
  EXPECT_GE(full.precision(), 0.80);
}

TEST_P(BusyRoom, DepthKeepsStaticPointsThatWholeBoxesLose) {
  const PointQuality box = measure(busy_room(GetParam()), Variant::box);
  const PointQuality full = measure(busy_room(GetParam()), Variant::full);
  EXPECT_EQ(box.in_person_kept, 0);
  EXPECT_GT(full.kept_in_persons(), 0.5);
  EXPECT_GT(full.precision(), box.precision());
}

INSTANTIATE_TEST_SUITE_P(Seeds, BusyRoom, ::testing::Values(11, 12));

TEST(EmptyRoom, HardlyAnythingIsRejectedWhereOnlyAFanTurns) {
  WorldOptions world;
  world.frames = 36;
  world.depth = DepthModel::kinect;
  const PointQuality full = measure(world, Variant::full);
  ASSERT_GT(full.stationary, 500);
  // A fan counts as one thing: its stand goes with its blades.
  EXPECT_LE(full.stationary_rejected, 0.08 * full.stationary);
}

TEST(BusyRoomOff, RejectsNothing) {
  const PointQuality off = measure(busy_room(11), Variant::off);
  EXPECT_GT(off.moving, 500);
  EXPECT_EQ(off.rejected(), 0);
}

}  // namespace
}  // namespace ydd
