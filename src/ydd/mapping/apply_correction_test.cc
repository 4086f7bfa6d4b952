// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/apply_correction.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using namespace testing_world;  // NOLINT(google-build-using-namespace)

struct CorrectedScene {
  PointWorld world = make_world(400, 5);
  BuiltMap built;
  explicit CorrectedScene(int views) : built(make(world, views)) {}
  static BuiltMap make(const PointWorld& world, int views) {
    std::vector<View> looks;
    for (int i = 0; i < views; ++i) looks.push_back(look(world, hand_held(0.2 * i)));
    return build_map(world, looks);
  }
};

SE3 shift(double x_m) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, 0)}; }

TEST(ApplyCorrection, PointsFollowTheirFirstKeyframeAndNewcomersTheirParent) {
  CorrectedScene scene(4);
  Atlas& atlas = scene.built.atlas;
  std::vector<SE3> before;
  for (const KeyFrameId id : scene.built.keyframes) before.push_back(atlas.at(id).T_world_camera);
  Correction correction;  // knows all but the last keyframe
  for (std::size_t i = 0; i + 1 < before.size(); ++i) {
    correction.T_world_keyframe[scene.built.keyframes[i]] = shift(1.0) * before[i];
  }
  const MapPointId point = atlas.at(scene.built.keyframes[0]).points[0];
  const Eigen::Vector3d p_before = atlas.at(point).p_world;
  apply_correction(atlas, correction);
  EXPECT_NEAR((atlas.at(point).p_world - p_before - Eigen::Vector3d(1, 0, 0)).norm(), 0.0, 1e-9);
  const SE3 newcomer = atlas.at(scene.built.keyframes.back()).T_world_camera;
  EXPECT_NEAR((newcomer.translation() - before.back().translation()).x(), 1.0, 1e-9);
  // Everything moved by the same metre: each point is still seen where it was.
  int points = 0;
  atlas.points().for_each([&](MapPointId id, const MapPoint& moved) {
    const auto at = std::find(scene.built.points.begin(), scene.built.points.end(), id);
    ASSERT_NE(at, scene.built.points.end());
    const auto i = static_cast<std::size_t>(at - scene.built.points.begin());
    EXPECT_LT((moved.p_world - scene.world.p_world[i] - Eigen::Vector3d(1, 0, 0)).norm(), 1e-9);
    ++points;
  });
  EXPECT_GT(points, 100);
}

TEST(ApplyCorrection, ANewcomerMayHaveAYoungerParent) {
  CorrectedScene scene(5);
  Atlas& atlas = scene.built.atlas;
  const auto& ids = scene.built.keyframes;
  // 3 and 4 came after the snapshot; the parent of 3 was culled since and the younger 4 took it in.
  atlas.set_parent(ids[4], ids[1]);
  atlas.set_parent(ids[3], ids[4]);
  Correction correction;
  for (std::size_t i = 0; i < 3; ++i) {
    correction.T_world_keyframe[ids[i]] = shift(1.0) * atlas.at(ids[i]).T_world_camera;
  }
  const double before_m = atlas.at(ids[3]).T_world_camera.translation().x();
  apply_correction(atlas, correction);
  EXPECT_NEAR(atlas.at(ids[3]).T_world_camera.translation().x() - before_m, 1.0, 1e-9);
}

TEST(ApplyCorrection, OlderOnesThatItDoesNotNameStayWithTheirPoints) {
  CorrectedScene scene(5);
  Atlas& atlas = scene.built.atlas;
  const auto& ids = scene.built.keyframes;
  for (std::size_t i = 1; i < ids.size(); ++i) atlas.set_parent(ids[i], ids[i - 1]);
  Correction correction;  // the last keyframe came after the snapshot, the one before it did not
  correction.newcomers_from = atlas.at(ids[4]).serial;
  correction.T_world_keyframe[ids[2]] = shift(1.0) * atlas.at(ids[2]).T_world_camera;
  std::vector<double> before_m;
  for (const KeyFrameId id : ids) {
    before_m.push_back(atlas.at(id).T_world_camera.translation().x());
  }
  const MapPointId point = atlas.at(ids[0]).points[0];  // first seen by a keyframe that stays
  const Eigen::Vector3d p_before = atlas.at(point).p_world;
  apply_correction(atlas, correction);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_NEAR(atlas.at(ids[i]).T_world_camera.translation().x() - before_m[i], i == 2 ? 1.0 : 0.0,
                1e-9)
        << i;
  }
  EXPECT_EQ(atlas.at(point).p_world, p_before);
  atlas.set_parent(ids[4], ids[2]);
  correction.T_world_keyframe[ids[2]] = shift(1.0) * atlas.at(ids[2]).T_world_camera;
  apply_correction(atlas, correction);
  EXPECT_NEAR(atlas.at(ids[4]).T_world_camera.translation().x() - before_m[4], 1.0, 1e-9);
}

TEST(ApplyCorrection, WhereACulledKeyframeStoodMovesAlong) {
  CorrectedScene scene(5);
  Atlas& atlas = scene.built.atlas;
  Correction correction;
  for (const KeyFrameId id : scene.built.keyframes) {
    correction.T_world_keyframe[id] = shift(1.0) * atlas.at(id).T_world_camera;
  }
  const KeyFrameId culled = scene.built.keyframes[2];
  const SE3 before = atlas.at(culled).T_world_camera;
  atlas.cull_keyframe(culled);
  apply_correction(atlas, correction);
  const SE3 after = atlas.T_world_keyframe(culled).value();
  EXPECT_NEAR((after.translation() - before.translation() - Eigen::Vector3d(1, 0, 0)).norm(), 0.0,
              1e-9);
  EXPECT_TRUE(atlas.check_consistency().empty());
}

TEST(ApplyCorrection, StaleIdsAreIgnored) {
  CorrectedScene scene(3);
  Atlas& atlas = scene.built.atlas;
  Correction correction;
  correction.T_world_keyframe[KeyFrameId{999, 7}] = shift(1.0);
  correction.p_world[MapPointId{999, 7}] = Eigen::Vector3d::Zero();
  const SE3 before = atlas.at(scene.built.keyframes[1]).T_world_camera;
  apply_correction(atlas, correction);
  const SE3 after = atlas.at(scene.built.keyframes[1]).T_world_camera;
  EXPECT_NEAR((after.translation() - before.translation()).norm(), 0.0, 1e-12);
}

TEST(MergeAt, FusesDuplicatesAndJoinsMaps) {
  CorrectedScene scene(3);
  Atlas& atlas = scene.built.atlas;
  // The same place once more, as a map of its own with points of its own.
  const MapId second = atlas.new_map();
  const View view = look(scene.world, hand_held(0.1));
  KeyFrame keyframe = keyframe_of(view, 50);
  keyframe.map = second;
  const KeyFrameId id = atlas.add_keyframe(std::move(keyframe));
  for (std::size_t k = 0; k < view.shown.size(); ++k) {
    atlas.add_point(scene.world.p_world[static_cast<std::size_t>(view.shown[k])], id,
                    static_cast<int>(k));
  }
  const std::size_t points_before = atlas.points().size();
  merge_at(atlas, {id, scene.built.keyframes[0]}, 3.0, 15, MatchLimits());
  EXPECT_TRUE(atlas.check_consistency().empty());
  EXPECT_EQ(atlas.at(id).map, atlas.at(scene.built.keyframes[0]).map);
  EXPECT_EQ(atlas.at(id).parent, scene.built.keyframes[0]);
  EXPECT_LT(atlas.points().size(), points_before - view.shown.size() / 2);
  EXPECT_FALSE(atlas.at(id).covisible.empty());
}

TEST(MergeAt, LeavesTheMapAloneWhenASideIsGone) {
  CorrectedScene scene(4);
  Atlas& atlas = scene.built.atlas;
  const Correction::Junction junction{scene.built.keyframes[3], scene.built.keyframes[1]};
  atlas.cull_keyframe(scene.built.keyframes[1]);
  const std::uint64_t revision = atlas.revision();
  merge_at(atlas, junction, 3.0, 15, MatchLimits());
  EXPECT_EQ(atlas.revision(), revision);
}

/// Moves each of the first keyframes differently, as a pose graph does.
Correction bent(const Atlas& atlas, const std::vector<KeyFrameId>& ids) {
  Correction correction;
  correction.revision = atlas.revision();
  correction.newcomers_from = atlas.next_serial();
  for (std::size_t i = 0; i + 1 < ids.size(); ++i) {
    Vector6d twist;
    twist << 0.05 * static_cast<double>(i), 0.02, -0.01, 0.004, 0.0, 0.01;
    correction.T_world_keyframe[ids[i]] = SE3::exp(twist) * atlas.at(ids[i]).T_world_camera;
  }
  return correction;
}

TEST(PreparedCorrection, OfAMapThatHasNotChangedIsAppliedBitByBitAsWithoutIt) {
  CorrectedScene scene(6), again(6);
  Correction correction = bent(scene.built.atlas, scene.built.keyframes);
  apply_correction(scene.built.atlas, correction);
  const auto before = again.built.atlas.snapshot();
  const std::string dump = dump_map(*before);
  prepare_correction(before, correction);
  apply_correction(again.built.atlas, correction);
  EXPECT_EQ(dump_map(again.built.atlas), dump_map(scene.built.atlas));
  EXPECT_EQ(dump_map(*before), dump) << "the snapshot stays as it was";
  EXPECT_TRUE(again.built.atlas.check_consistency().empty());
}

TEST(PreparedCorrection, MovesWhatHasChangedMeanwhileLikeTheRest) {
  CorrectedScene scene(6), again(6);
  const auto& ids = scene.built.keyframes;
  Correction correction = bent(scene.built.atlas, ids);
  Correction prepared = correction;
  prepare_correction(again.built.atlas.snapshot(), prepared);
  // Meanwhile the mapper refines one keyframe, moves a point, takes another out and adds a
  // keyframe.
  const auto go_on = [&](Atlas& atlas) {
    Vector6d twist;
    twist << 0.001, 0, 0, 0, 0.001, 0;
    const MapPointId refined = atlas.points().ids()[20];
    atlas.set_position(refined, atlas.at(refined).p_world + Eigen::Vector3d(0.01, 0, 0));
    atlas.remove_point(atlas.points().ids()[10]);
    atlas.set_pose(ids[2], SE3::exp(twist) * atlas.at(ids[2]).T_world_camera);
    KeyFrame newcomer = keyframe_of(look(scene.world, hand_held(1.3)), 50);
    newcomer.map = atlas.at(ids[0]).map;
    newcomer.parent = ids[2];
    const KeyFrameId added = atlas.add_keyframe(std::move(newcomer));
    return atlas.add_point({0.3, 0.2, 2.0}, added, 0);
  };
  const MapPointId point = go_on(scene.built.atlas);
  ASSERT_EQ(go_on(again.built.atlas), point);
  apply_correction(scene.built.atlas, correction);
  apply_correction(again.built.atlas, prepared);
  const Atlas& a = scene.built.atlas;
  const Atlas& b = again.built.atlas;
  EXPECT_TRUE(b.check_consistency().empty());
  EXPECT_LT((a.at(point).p_world - b.at(point).p_world).norm(), 1e-12);
  for (const KeyFrameId id : a.keyframes().ids()) {
    EXPECT_EQ(a.at(id).T_world_camera.matrix(), b.at(id).T_world_camera.matrix());
  }
  ASSERT_EQ(a.points().ids(), b.points().ids());
  a.points().for_each([&](MapPointId id, const MapPoint& p) {
    EXPECT_EQ(p.observations, b.at(id).observations);
    EXPECT_EQ(p.descriptor, b.at(id).descriptor);
    // Points that the refined keyframe saw first lie as the snapshot saw them from there.
    const bool by_refined = p.observations.front().keyframe == ids[2];
    EXPECT_LT((p.p_world - b.at(id).p_world).norm(), by_refined ? 0.01 : 1e-12);
    EXPECT_LT((p.normal - b.at(id).normal).norm(), 0.01);
  });
}

}  // namespace
}  // namespace ydd
