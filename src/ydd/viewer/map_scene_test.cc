// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/map_scene.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using Eigen::Vector3d;
using testing_world::PointWorld;

/// A camera that walked to the right past a wall of points and kept each frame.
struct Walk {
  static constexpr int kKeyframes = 4;
  PointWorld world = testing_world::make_world(300, 3);
  Atlas atlas{world.camera, world.scales};
  std::vector<KeyFrameId> keyframes;
  LiveHistory history;
  FrameReport report;
  StampedPoses truth;

  Walk() {
    const MapId map = atlas.new_map();
    for (int i = 0; i < kKeyframes; ++i) add(map, i);
    for (std::size_t k = 0; k < 100; ++k) share(static_cast<int>(k));
    for (const KeyFrameId id : keyframes) atlas.refresh_covisibility(id, 15);
    report.track.state = TrackingState::tracking;
    report.track.reference = keyframes.back();
    report.points = atlas.at(keyframes.back()).points;
  }
  static SE3 pose(int i) { return {Eigen::Quaterniond::Identity(), {0.2 * i, 0, 0}}; }
  static Timestamp stamp(int i) { return {i * 100'000'000LL}; }

  void add(MapId map, int i) {
    const auto view = testing_world::look(world, pose(i));
    KeyFrame keyframe;
    keyframe.map = map;
    keyframe.frame_index = i;
    keyframe.stamp = stamp(i);
    keyframe.T_world_camera = pose(i);
    keyframe.shared_features = view.shared_features;
    keyframe.grid = view.grid;
    keyframe.points.resize(view.features().size());
    keyframes.push_back(atlas.add_keyframe(keyframe));
    remember(i, keyframes.back());
    truth.push_back({stamp(i), pose(i)});
  }
  void remember(int i, KeyFrameId reference) {
    LiveSample sample;
    sample.index = i;
    sample.stamp = stamp(i);
    sample.state = reference.valid() ? TrackingState::tracking : TrackingState::lost;
    sample.reference = reference;
    history.insert(sample);
  }
  /// Keypoint k of each keyframe sees one point: where it really is does not matter here.
  void share(int k) {
    const MapPointId id = atlas.add_point({0.01 * k, 0, 2}, keyframes.front(), k);
    for (std::size_t i = 1; i < keyframes.size(); ++i) atlas.add_observation(id, keyframes[i], k);
  }
  LiveFrame live() {
    LiveFrame live;
    live.report = std::make_shared<const FrameReport>(report);
    live.atlas = atlas.snapshot();
    live.history = std::make_shared<const LiveHistory>(history.snapshot());
    return live;
  }
};

std::size_t lines(const Vertices& vertices) { return vertices.size() / 2; }

TEST(MapScene, DrawsPointsKeyframesAndWhatConnectsThem) {
  Walk walk;
  const MapScene scene = build_map_scene(walk.live(), {});
  EXPECT_EQ(scene.points.size(), 100U);
  EXPECT_EQ(scene.point_count, 100);
  EXPECT_EQ(scene.keyframe_count, 4);
  EXPECT_EQ(scene.maps, 1);
  EXPECT_EQ(lines(scene.keyframes), 4U * 8U);
  EXPECT_EQ(lines(scene.covisibility), 6U);  // each pair of four, once
  EXPECT_EQ(lines(scene.trajectory), 3U);
  EXPECT_TRUE(scene.loops.empty());
  EXPECT_TRUE(scene.truth.empty());
  EXPECT_FALSE(scene.error_rmse_m);
  EXPECT_FALSE(scene.grid.empty());
}

TEST(MapScene, LoopEdgesAreDrawnOnce) {
  Walk walk;
  walk.atlas.add_loop(walk.keyframes[3], walk.keyframes[0]);
  const MapScene scene = build_map_scene(walk.live(), {});
  ASSERT_EQ(lines(scene.loops), 1U);
  const std::set<float> ends = {scene.loops[0].p_world[0], scene.loops[1].p_world[0]};
  EXPECT_EQ(ends, (std::set<float>{0.0F, 0.6F}));
}

TEST(MapScene, ATrajectoryHasAGapWhereTheCameraWasLost) {
  Walk walk;
  walk.remember(5, {});
  walk.remember(6, walk.keyframes[3]);
  walk.remember(7, walk.keyframes[3]);
  EXPECT_EQ(lines(build_map_scene(walk.live(), {}).trajectory), 4U);
}

TEST(MapScene, TheTrajectoryFollowsCorrectionsOfTheMap) {
  Walk walk;
  walk.atlas.set_pose(walk.keyframes[3], SE3(Eigen::Quaterniond::Identity(), {0.6, 1, 0}));
  const MapScene scene = build_map_scene(walk.live(), {});
  EXPECT_FLOAT_EQ(scene.trajectory.back().p_world[1], 1.0F);
}

TEST(MapScene, TruthAndErrorsAreDrawnWhereThereIsTruth) {
  Walk walk;
  const MapScene scene = build_map_scene(walk.live(), walk.truth);
  EXPECT_EQ(lines(scene.truth), 3U);
  EXPECT_EQ(lines(scene.errors), 4U);
  EXPECT_LT(scene.error_rmse_m.value(), 1e-9);
}

TEST(MapScene, OtherMapsAreCountedNotDrawn) {
  Walk walk;
  walk.add(walk.atlas.new_map(), 9);
  walk.report.track.reference = walk.keyframes.back();
  const MapScene scene = build_map_scene(walk.live(), {});
  EXPECT_EQ(scene.maps, 2);
  EXPECT_EQ(scene.keyframe_count, 1);
  EXPECT_EQ(scene.points.size(), 0U);
  walk.report.track.state = TrackingState::lost;  // then the last tracked frame decides
  EXPECT_EQ(build_map_scene(walk.live(), {}).keyframe_count, 1);
}

TEST(MapScene, BeforeThereIsAMapThereIsNothing) {
  Walk walk;
  LiveFrame live = walk.live();
  live.atlas = Atlas(walk.world.camera, walk.world.scales).snapshot();
  live.history = std::make_shared<const LiveHistory>();
  FrameReport report;
  live.report = std::make_shared<const FrameReport>(report);
  const MapScene scene = build_map_scene(live, walk.truth);
  EXPECT_TRUE(scene.points.empty());
  EXPECT_TRUE(scene.trajectory.empty());
  EXPECT_FALSE(build_current_scene(live, walk.world.camera).T_world_camera);
}

TEST(MapScene, AFarPointDoesNotShrinkTheRest) {
  Walk walk;
  const double radius_m = build_map_scene(walk.live(), {}).radius_m;
  auto id = MapPointId{};
  walk.atlas.points().for_each([&](MapPointId point, const MapPoint&) { id = point; });
  walk.atlas.set_position(id, {1000, 1000, 1000});
  EXPECT_LT(build_map_scene(walk.live(), {}).radius_m, 2 * radius_m);
}

TEST(CurrentScene, ShowsSeenPointsAndTheCameraByItsState) {
  Walk walk;
  CurrentScene scene = build_current_scene(walk.live(), walk.world.camera);
  EXPECT_EQ(scene.seen_points.size(), 100U);
  ASSERT_TRUE(scene.T_world_camera);
  EXPECT_NEAR(scene.T_world_camera->translation().x(), 0.6, 1e-9);
  EXPECT_EQ(scene.camera.front().rgba, scene_colour::kTracking);
  walk.report.track.state = TrackingState::lost;
  walk.report.points.clear();
  scene = build_current_scene(walk.live(), walk.world.camera);
  EXPECT_TRUE(scene.seen_points.empty());
  ASSERT_TRUE(scene.T_world_camera);
  EXPECT_EQ(scene.camera.front().rgba, scene_colour::kLost);
}

WorldTrack walker() {
  WorldTrack track;
  track.id = 7;
  track.class_name = "person";
  track.position_m = {0.6, 0, 3};
  track.extent_m = {0.5, 1.8, 0.4};
  track.velocity_m_s = {0.5, 0, 0};
  return track;
}

TEST(CurrentScene, PeopleAndThingsHaveBoxesArrowsAndNames) {
  Walk walk;
  walk.report.track.T_world_camera = Walk::pose(3);
  WorldTrack chair = walker();
  chair.id = 9;
  chair.class_name = "chair";
  chair.velocity_m_s.setZero();
  chair.unseen_s = 0.4;
  walk.report.tracks = {walker(), chair};
  const CurrentScene scene = build_current_scene(walk.live(), walk.world.camera);
  ASSERT_EQ(lines(scene.tracks), 12U + 3U + 12U) << "the chair stands: no arrow";
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < 24; ++i) box.extend(Eigen::Vector3f(scene.tracks[i].p_world.data()));
  EXPECT_TRUE(box.sizes().isApprox(Eigen::Vector3f(0.5F, 1.8F, 0.4F), 1e-3F));
  EXPECT_TRUE(box.center().isApprox(Eigen::Vector3f(0.6F, 0, 3), 1e-3F));
  EXPECT_FLOAT_EQ(scene.tracks[25].p_world[0], 1.1F) << "where it is in a second";
  EXPECT_EQ(scene.tracks.front().rgba, scene_colour::kTrack);
  EXPECT_LT(scene.tracks.back().rgba[3], 255) << "not seen now: pale";
  ASSERT_EQ(scene.labels.size(), 2U);
  EXPECT_EQ(scene.labels[0].text, "person 7");
  EXPECT_LT(scene.labels[0].p_world.y(), -0.9) << "above its head: y points down";
  EXPECT_EQ(scene.labels[1].text, "chair 9");
}

TEST(CurrentScene, TracksFollowCorrectionsOfTheMap) {
  Walk walk;
  walk.report.track.T_world_camera = Walk::pose(3);
  walk.report.tracks = {walker()};
  walk.atlas.set_pose(walk.keyframes[3], SE3(Eigen::Quaterniond::Identity(), {0.6, 0, 1}));
  const CurrentScene scene = build_current_scene(walk.live(), walk.world.camera);
  EXPECT_NEAR(scene.labels.at(0).p_world.z(), 4, 1e-9);
}

}  // namespace
}  // namespace ydd
