// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/mapper.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/map_dump.h"
#include "ydd/system/walk_testing.h"

namespace ydd {
namespace {

using testing::IsEmpty;
using testing_world::candidate_of;
using testing_world::hand_held;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::position_error_m;
using testing_world::View;
using testing_world::Walker;

Mapper mapper_for(const PointWorld& world) { return {world.camera, world.scales, MapperOptions{}}; }

TEST(Mapper, KeepsTheMapConsistentAndTheCameraInPlace) {
  Walker walker;
  Mapper mapper = mapper_for(walker.world());
  int processed = 0;
  int fused = 0;
  int triangulated = 0;
  double worst_m = 0;
  for (int i = 0; i < 120; ++i) {
    const TrackResult result = walker.step(mapper.atlas());
    ASSERT_EQ(result.state, TrackingState::tracking) << "frame " << i;
    if (i > 0) {
      worst_m = std::max(worst_m, position_error_m(result.T_world_camera, Walker::path(i)));
    }
    if (!result.candidate) continue;
    const MapperReport report = mapper.process(*result.candidate);
    ++processed;
    fused += report.points_fused;
    triangulated += report.points_triangulated;
    ASSERT_THAT(mapper.atlas().check_consistency(), IsEmpty()) << "frame " << i;
    EXPECT_NE(mapper.atlas().find(report.keyframe), nullptr);
    EXPECT_EQ(report.times.size(), 6U);
  }
  EXPECT_GE(processed, 3);
  EXPECT_GT(fused, 0);
  EXPECT_GT(triangulated, 0);
  EXPECT_LT(worst_m, 0.01);
}

TEST(Mapper, TheFirstKeyframeMakesAPointOfEveryReading) {
  const PointWorld world = make_world(600, 8);
  Mapper mapper = mapper_for(world);
  const View view = look(world, SE3());
  const MapperReport report = mapper.process(candidate_of(view, 0, {}, {}));
  const auto& depths = view.features().depth_m;
  EXPECT_EQ(report.points_from_depth,
            std::count_if(depths.begin(), depths.end(), [](float d) { return d > 0; }));
  EXPECT_EQ(mapper.atlas().points().size(), static_cast<std::size_t>(report.points_from_depth));
  for (std::size_t k = 0; k < view.shown.size(); ++k) {
    const MapPointId id = mapper.atlas().at(report.keyframe).points[k];
    ASSERT_EQ(id.valid(), depths[k] > 0);
    if (!id.valid()) continue;
    const auto& truth = world.p_world[static_cast<std::size_t>(view.shown[k])];
    EXPECT_LT((mapper.atlas().at(id).p_world - truth).norm(), 1e-4);
  }
}

TEST(Mapper, MakesFarPointsOnlyAsFarAsAskedFor) {
  const PointWorld world = make_world(600, 8);
  MapperOptions options;
  options.min_depth_points = 20;
  options.close_depth_m = 2.0;
  Mapper mapper(world.camera, world.scales, options);
  const View view = look(world, SE3());
  mapper.process(candidate_of(view, 0, {}, {}));
  const auto& depths = view.features().depth_m;
  const auto near =
      std::count_if(depths.begin(), depths.end(), [](float d) { return d > 0 && d <= 2.0F; });
  EXPECT_EQ(mapper.atlas().points().size(), static_cast<std::size_t>(std::max<long>(near, 20)));
}

TEST(Mapper, APoseIsKeptRelativeToItsReference) {
  const PointWorld world = make_world(600, 8);
  Mapper mapper = mapper_for(world);
  const KeyFrameId first = mapper.process(candidate_of(look(world, SE3()), 0, {}, {})).keyframe;
  // The tracker worked on an older map: its own pose is off by a metre, the relation is right.
  const View view = look(world, hand_held(0.5));
  KeyFrameCandidate late = candidate_of(view, 1, first, view.T_world_camera);
  late.frame.T_camera_world =
      SE3(Eigen::Quaterniond::Identity(), {1, 0, 0}) * late.frame.T_camera_world;
  const KeyFrameId id = mapper.process(late).keyframe;
  EXPECT_LT(position_error_m(mapper.atlas().at(id).T_world_camera, view.T_world_camera), 0.01);
  EXPECT_EQ(mapper.atlas().at(id).parent, first);
}

/// Submits views of one place until keyframes are found redundant; gives one that was culled.
KeyFrameId cull_one(Mapper& mapper, const PointWorld& world) {
  std::vector<KeyFrameId> ids;
  for (int i = 0; i < 12; ++i) {
    const View view = look(world, SE3());
    KeyFrameCandidate candidate =
        candidate_of(view, i, ids.empty() ? KeyFrameId{} : ids.front(), {});
    if (!ids.empty()) candidate.frame.points = mapper.atlas().at(ids.front()).points;
    ids.push_back(mapper.process(candidate).keyframe);
  }
  for (const KeyFrameId id : ids) {
    if (!mapper.atlas().find(id)) return id;
  }
  return {};
}

TEST(Mapper, ACulledReferenceDoesNotStartAnotherMap) {
  const PointWorld world = make_world(600, 8);
  Mapper mapper = mapper_for(world);
  const KeyFrameId culled = cull_one(mapper, world);
  ASSERT_TRUE(culled.valid());
  const View view = look(world, hand_held(0.5));
  const KeyFrameId id =
      mapper.process(candidate_of(view, 50, culled, view.T_world_camera)).keyframe;
  const KeyFrame& keyframe = mapper.atlas().at(id);
  EXPECT_LT(position_error_m(keyframe.T_world_camera, view.T_world_camera), 0.01);
  EXPECT_TRUE(keyframe.parent.valid());
  mapper.atlas().keyframes().for_each(
      [&](KeyFrameId, const KeyFrame& other) { EXPECT_EQ(other.map, keyframe.map); });
  EXPECT_THAT(mapper.atlas().check_consistency(), IsEmpty());
}

TEST(Mapper, AStopLeavesAValidMap) {
  Walker walker;
  Mapper mapper = mapper_for(walker.world());
  std::stop_source stop;
  stop.request_stop();
  int processed = 0;
  for (int i = 0; i < 60; ++i) {
    const TrackResult result = walker.step(mapper.atlas());
    ASSERT_EQ(result.state, TrackingState::tracking) << "frame " << i;
    if (!result.candidate) continue;
    const MapperReport report = mapper.process(*result.candidate, stop.get_token());
    ASSERT_NE(mapper.atlas().find(report.keyframe), nullptr);
    ASSERT_THAT(mapper.atlas().check_consistency(), IsEmpty());
    ++processed;
  }
  EXPECT_GE(processed, 2);
}

/// A map of a walk, and the correction that moves all of it by `x_m`, as of now.
Correction moved_along_x(const Mapper& mapper, double x_m) {
  Correction correction;
  correction.revision = mapper.atlas().revision();
  mapper.atlas().keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    correction.T_world_keyframe[id] =
        SE3(Eigen::Quaterniond::Identity(), {x_m, 0, 0}) * keyframe.T_world_camera;
  });
  return correction;
}

class Corrections : public testing::Test {
 protected:
  /// Walks until the map has `keyframes` more than now.
  void walk(int keyframes) {
    while (keyframes > 0) {
      const TrackResult result = walker_.step(mapper_.atlas());
      ASSERT_EQ(result.state, TrackingState::tracking);
      if (!result.candidate) continue;
      mapper_.process(*result.candidate);
      --keyframes;
    }
  }
  double x_of_newest_m() const {
    return mapper_.atlas().at(mapper_.atlas().newest_keyframe()).T_world_camera.translation().x();
  }
  Walker walker_;
  Mapper mapper_ = mapper_for(walker_.world());
};

TEST_F(Corrections, OfTheMapAsItIsAreApplied) {
  walk(2);
  const double before_m = x_of_newest_m();
  EXPECT_EQ(mapper_.apply(moved_along_x(mapper_, 1.0)), Applied::as_computed);
  EXPECT_NEAR(x_of_newest_m() - before_m, 1.0, 1e-9);
}

TEST_F(Corrections, ArePassedOnToKeyframesThatCameMeanwhile) {
  walk(2);
  const Correction correction = moved_along_x(mapper_, 1.0);
  walk(1);
  const double before_m = x_of_newest_m();
  EXPECT_EQ(mapper_.apply(correction), Applied::rebased);
  EXPECT_NEAR(x_of_newest_m() - before_m, 1.0, 0.05);  // and what the newcomer has refined
  EXPECT_THAT(mapper_.atlas().check_consistency(), IsEmpty());
}

TEST_F(Corrections, ThatWouldUndoANewerOneAreRefused) {
  walk(2);
  const Correction early = moved_along_x(mapper_, 1.0);
  ASSERT_EQ(mapper_.apply(moved_along_x(mapper_, 5.0)), Applied::as_computed);
  const std::string before = dump_map(mapper_.atlas());
  EXPECT_EQ(mapper_.apply(early), Applied::refused);
  EXPECT_EQ(dump_map(mapper_.atlas()), before) << "nothing has been changed";
  EXPECT_EQ(mapper_.apply(moved_along_x(mapper_, 1.0)), Applied::as_computed);
}

TEST(Mapper, SnapshotsStayWhileTheMapGoesOn) {
  Walker walker;
  Mapper mapper = mapper_for(walker.world());
  std::shared_ptr<const Atlas> early;
  std::string dump;
  for (int i = 0; i < 60; ++i) {
    const TrackResult result = walker.step(mapper.atlas());
    if (result.candidate) mapper.process(*result.candidate);
    if (i != 10) continue;
    early = mapper.snapshot();
    dump = dump_map(*early);
  }
  EXPECT_EQ(dump_map(*early), dump);
  EXPECT_NE(dump_map(mapper.atlas()), dump);
}

std::string map_after(int frames) {
  Walker walker;
  Mapper mapper = mapper_for(walker.world());
  for (int i = 0; i < frames; ++i) {
    const TrackResult result = walker.step(mapper.atlas());
    if (result.candidate) mapper.process(*result.candidate);
  }
  return dump_map(mapper.atlas());
}

TEST(Mapper, IsDeterministic) { EXPECT_EQ(map_after(60), map_after(60)); }

}  // namespace
}  // namespace ydd
