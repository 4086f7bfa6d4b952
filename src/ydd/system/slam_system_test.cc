// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/slam_system.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/map_dump.h"
#include "ydd/system/picture_testing.h"

namespace ydd {
namespace {

using testing::IsEmpty;
using testing_world::Wall;

constexpr int kFrames = 40;

SystemOptions options_for(bool deterministic, Variant variant = Variant::off) {
  SystemOptions options;
  options.deterministic = deterministic;
  options.dynamics.variant = variant;
  options.dynamics.compensation.points = 500;
  return options;
}

/// Sees the same person in every frame; from frame `fails_at` on it cannot.
class Fixed final : public Detector {
 public:
  explicit Fixed(std::int64_t fails_at = 1'000'000) : fails_at_(fails_at) {}
  Result<Detections> detect(const RgbdFrame& frame) override {
    if (frame.index >= fails_at_) return Error{"recording.jsonl: frame 5 is not recorded"};
    return Detections{{"person", 0.9F, {100, 40, 180, 240}}};
  }

 private:
  std::int64_t fails_at_;
};

class System : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Both, System, testing::Values(true, false), [](const auto& test) {
  return std::string(test.param ? "Inline" : "Threaded");
});

TEST_P(System, FollowsTheCameraAndResolvesEveryFrame) {
  const Wall wall(kFrames);
  SlamSystem system(wall.camera(), options_for(GetParam()), ObjectCatalogue::defaults(), nullptr);
  system.set_patient(true);  // how accurate it is must not depend on what else the machine does
  for (int i = 0; i < kFrames; ++i) {
    const Result<FrameReport> report = system.process(wall.frame(i));
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->index, i);
    EXPECT_EQ(report->stamp, wall.stamp(i));
    EXPECT_EQ(report->track.state, TrackingState::tracking) << "frame " << i;
    EXPECT_EQ(report->points.size(), report->filtered->kept->size());
    EXPECT_FALSE(report->track.candidate.has_value());
    ASSERT_FALSE(report->times.empty());
    EXPECT_EQ(report->times.back().stage, "total");
  }
  EXPECT_TRUE(system.finish());
  const StampedPoses trajectory = system.trajectory();
  ASSERT_EQ(trajectory.size(), static_cast<std::size_t>(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    const StampedPose& pose = trajectory[static_cast<std::size_t>(i)];
    EXPECT_EQ(pose.stamp, wall.stamp(i));
    const SE3 error = wall.T_world_camera(i).inverse() * pose.T_world_camera;
    EXPECT_LT(error.translation().norm(), 0.02) << "frame " << i;
    EXPECT_LT(error.angle_rad(), 0.005) << "frame " << i;
  }
  EXPECT_THAT(system.atlas()->check_consistency(), IsEmpty());
  const StampedPoses keyframes = system.keyframe_trajectory();
  EXPECT_EQ(keyframes.size(), system.atlas()->keyframes().size());
  EXPECT_TRUE(std::is_sorted(keyframes.begin(), keyframes.end(),
                             [](const auto& a, const auto& b) { return a.stamp < b.stamp; }));
  EXPECT_GE(system.mapping_reports().keyframes.size(), 2U);
}

TEST_P(System, ResetForgetsEverythingAndStartsAfresh) {
  const Wall wall(kFrames);
  SlamSystem system(wall.camera(), options_for(GetParam()), ObjectCatalogue::defaults(), nullptr);
  SlamSystem fresh(wall.camera(), options_for(true), ObjectCatalogue::defaults(), nullptr);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(system.process(wall.frame(i)).ok());
  system.reset();
  EXPECT_EQ(system.atlas()->keyframes().size(), 0U);
  EXPECT_THAT(system.trajectory(), IsEmpty());
  for (int i = 20; i < kFrames; ++i) {
    ASSERT_TRUE(system.process(wall.frame(i)).ok());
    ASSERT_TRUE(fresh.process(wall.frame(i)).ok());
  }
  EXPECT_TRUE(system.finish());
  EXPECT_TRUE(fresh.finish());
  if (GetParam()) {  // else the mapper's pace decides
    EXPECT_EQ(dump_map(*system.atlas()), dump_map(*fresh.atlas()));
  }
  EXPECT_EQ(system.trajectory().size(), static_cast<std::size_t>(kFrames - 20));
  EXPECT_EQ(system.trajectory().front().stamp, wall.stamp(20));
}

TEST(PatientSystem, ThatAllowsNoLagMapsOnThreadsAsInOne) {
  const Wall wall(kFrames);
  SystemOptions options = options_for(false);
  options.mapping_lag_s = 0;
  SlamSystem patient(wall.camera(), options, ObjectCatalogue::defaults(), nullptr);
  patient.set_patient(true);
  SlamSystem inline_system(wall.camera(), options_for(true), ObjectCatalogue::defaults(), nullptr);
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(patient.process(wall.frame(i)).ok());
    ASSERT_TRUE(inline_system.process(wall.frame(i)).ok());
  }
  EXPECT_TRUE(patient.finish());
  EXPECT_TRUE(inline_system.finish());
  EXPECT_EQ(dump_map(*patient.atlas()), dump_map(*inline_system.atlas()));
}

TEST_P(System, TheVariantCanBeSwitchedBetweenFrames) {
  const Wall wall(kFrames);
  SlamSystem system(wall.camera(), options_for(GetParam(), Variant::off),
                    ObjectCatalogue::defaults(), std::make_unique<Fixed>());
  EXPECT_EQ(system.variant(), Variant::off);
  EXPECT_EQ(system.process(wall.frame(0))->judgement.rejected(), 0);
  system.set_variant(Variant::box);
  const Result<FrameReport> report = system.process(wall.frame(1));
  EXPECT_GT(count_rules(*report->filtered)[static_cast<std::size_t>(Rule::box)], 10);
  system.reset();
  EXPECT_EQ(system.variant(), Variant::box);
  system.set_variant(Variant::off);
  EXPECT_EQ(system.process(wall.frame(2))->judgement.rejected(), 0);
}

TEST_P(System, FramesWithoutAPoseAreNotInTheTrajectory) {
  const Wall wall(kFrames);
  SlamSystem system(wall.camera(), options_for(GetParam()), ObjectCatalogue::defaults(), nullptr);
  for (int i = 0; i < 20; ++i) {
    const bool dark = i < 2 || (i >= 10 && i < 13);
    const Result<FrameReport> report = system.process(dark ? wall.dark_frame(i) : wall.frame(i));
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->track.state == TrackingState::tracking, !dark) << "frame " << i;
  }
  EXPECT_TRUE(system.finish());
  const StampedPoses trajectory = system.trajectory();
  ASSERT_EQ(trajectory.size(), 15U);
  EXPECT_EQ(trajectory.front().stamp, wall.stamp(2));
  const double travelled_m = (trajectory.back().T_world_camera.translation() -
                              trajectory.front().T_world_camera.translation())
                                 .norm();
  EXPECT_NEAR(travelled_m,
              (wall.T_world_camera(19).translation() - wall.T_world_camera(2).translation()).norm(),
              0.01);
}

TEST_P(System, RejectedPointsNeverReachTheMap) {
  const Wall wall(kFrames);
  SlamSystem system(wall.camera(), options_for(GetParam(), Variant::box),
                    ObjectCatalogue::defaults(), std::make_unique<Fixed>());
  int rejected = 0;
  for (int i = 0; i < 10; ++i) {
    const Result<FrameReport> report = system.process(wall.frame(i));
    ASSERT_TRUE(report.ok());
    ASSERT_EQ(report->detections.size(), 1U);
    rejected += static_cast<int>(report->filtered->rejected.size());
  }
  EXPECT_TRUE(system.finish());
  EXPECT_GT(rejected, 0);
  const Box person{100, 40, 180, 240};
  std::size_t kept = 0;
  system.atlas()->keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    for (const Keypoint& k : keyframe.features().keypoints) {
      EXPECT_FALSE(person.contains(k.x_px, k.y_px));
      ++kept;
    }
  });
  EXPECT_GT(kept, 100U);
}

TEST_P(System, GivenDetectionsStandForTheDetectors) {
  const Wall wall(kFrames);
  SlamSystem system(wall.camera(), options_for(GetParam(), Variant::box),
                    ObjectCatalogue::defaults(), std::make_unique<Fixed>(5));
  ASSERT_TRUE(system.process(wall.frame(0)).ok());
  for (int i = 5; i < 10; ++i) {  // the detector would fail
    const Result<FrameReport> report = system.process(wall.frame(i), Detections{});
    ASSERT_TRUE(report.ok()) << report.error().message;
    EXPECT_THAT(report->detections, IsEmpty());
  }
  EXPECT_FALSE(system.process(wall.frame(10)).ok());
}

TEST(SlamSystem, GivesTheErrorOfItsDetector) {
  const Wall wall(kFrames);
  SlamSystem system(wall.camera(), options_for(true, Variant::full), ObjectCatalogue::defaults(),
                    std::make_unique<Fixed>(5));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(system.process(wall.frame(i)).ok());
  const Result<FrameReport> report = system.process(wall.frame(5));
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.error().message, "recording.jsonl: frame 5 is not recorded");
  EXPECT_TRUE(system.finish());
  EXPECT_EQ(system.trajectory().size(), 5U);
}

/// A frame that can be tracked, but no keyframe with a picture can be made of it: JPEG ends at
/// 65535 pixels.
RgbdFrame too_wide(RgbdFrame frame) {
  constexpr int kWidth = 140'000;
  static const DepthImage depth_m(kWidth, 240, std::vector<float>(std::size_t{kWidth} * 240, 2.0F));
  static const ColourImage colour(kWidth, 240, std::vector<Bgr>(std::size_t{kWidth} * 240));
  frame.depth_m = depth_m;
  frame.colour = colour;
  return frame;
}

TEST_P(System, AnExceptionInTheMapperEndsTheRunWithAnErrorAndKeepsWhatThereIs) {
  const Wall wall(kFrames);
  SystemOptions options = options_for(GetParam());
  options.map.pictures = true;
  SlamSystem system(wall.camera(), options, ObjectCatalogue::defaults(), nullptr);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(system.process(wall.frame(i)).ok());
  std::string failure;
  for (int i = 10; i < kFrames && failure.empty(); ++i) {
    const Result<FrameReport> report = system.process(too_wide(wall.frame(i)));
    if (!report) failure = report.error().message;
  }
  const Result<void> finished = system.finish();
  ASSERT_FALSE(finished.ok());
  EXPECT_THAT(finished.error().message, testing::StartsWith("mapping: internal: "));
  if (!failure.empty()) {
    EXPECT_EQ(failure, finished.error().message);
  }
  EXPECT_GE(system.trajectory().size(), 10U);
  EXPECT_GE(system.atlas()->keyframes().size(), 1U);
  EXPECT_THAT(system.atlas()->check_consistency(), IsEmpty());
}

TEST_P(System, AMapperThatFailsOnTheFirstFrameIsNotWaitedFor) {
  const Wall wall(kFrames);
  SystemOptions options = options_for(GetParam());
  options.map.pictures = true;
  SlamSystem system(wall.camera(), options, ObjectCatalogue::defaults(), nullptr);
  EXPECT_FALSE(system.process(too_wide(wall.frame(0))).ok());
  EXPECT_FALSE(system.process(wall.frame(1)).ok());
  EXPECT_FALSE(system.finish().ok());
  EXPECT_THAT(system.trajectory(), IsEmpty());
}

TEST(SlamSystem, IsDeterministicWhenAsked) {
  const auto run = [] {
    const Wall wall(kFrames);
    SlamSystem system(wall.camera(), options_for(true, Variant::full), ObjectCatalogue::defaults(),
                      std::make_unique<Fixed>());
    for (int i = 0; i < 25; ++i) EXPECT_TRUE(system.process(wall.frame(i)).ok());
    EXPECT_TRUE(system.finish());
    return format_trajectory(system.trajectory(), TrajectoryFormat::tum) +
           dump_map(*system.atlas());
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace ydd
