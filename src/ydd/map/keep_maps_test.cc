// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/keep_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/join_atlases.h"
#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using namespace testing_world;  // NOLINT(google-build-using-namespace)
using testing::IsEmpty;

Atlas map_of(int keyframes, unsigned seed) {
  const PointWorld world = make_world(200, seed);
  std::vector<View> views;
  for (int i = 0; i < keyframes; ++i) views.push_back(look(world, hand_held(0.2 * i)));
  BuiltMap built = build_map(world, views);
  if (keyframes > 4) built.atlas.cull_keyframe(built.keyframes[2]);
  return std::move(built.atlas);
}

/// Maps 0 (8 keyframes kept), 1 (2) and 2 (5).
Atlas three_maps() {
  Atlas first = join_atlases(map_of(9, 1), map_of(2, 2)).value();
  Atlas all = join_atlases(first, map_of(6, 3)).value();
  all.add_loop({0, 1}, all.newest_keyframe());  // between maps: goes with either
  return all;
}

TEST(KeepMaps, OneMapKeepsItsIdsAndNothingOfTheOthers) {
  const Atlas all = three_maps();
  const Result<Atlas> third = keep_maps(all, {{2, 1}});
  ASSERT_TRUE(third.ok()) << third.error().message;
  EXPECT_THAT(third->check_consistency(), IsEmpty());
  EXPECT_EQ(third->keyframes().size(), 5U);
  EXPECT_EQ(third->culled().size(), 1U);
  EXPECT_EQ(third->newest_keyframe(), all.newest_keyframe());
  third->keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    EXPECT_EQ(keyframe.serial, all.at(id).serial);
    EXPECT_EQ(keyframe.points, all.at(id).points);
    EXPECT_THAT(keyframe.loops, IsEmpty());
  });
  const Result<Atlas> first = keep_maps(all, {{0, 1}});
  ASSERT_TRUE(first.ok()) << first.error().message;
  EXPECT_EQ(first->keyframes().size(), 8U);
  EXPECT_EQ(first->at(first->newest_keyframe()).serial, 8);
  EXPECT_EQ(
      first->points().size() + third->points().size() + keep_maps(all, {{1, 1}})->points().size(),
      all.points().size());
}

TEST(KeepMaps, AllOfThemIsTheSameMap) {
  const Atlas all = three_maps();
  EXPECT_EQ(dump_map(keep_maps(all, {{0, 1}, {1, 1}, {2, 1}}).value()), dump_map(all));
}

TEST(KeepMaps, WhatIsNotThereCannotBeKept) {
  EXPECT_FALSE(keep_maps(three_maps(), {{7, 1}}).ok());
  EXPECT_FALSE(keep_maps(three_maps(), {}).ok());
}

TEST(PruneAtlas, SmallMapsAndPointsNeverSeenAgainGo) {
  Atlas all = three_maps();
  const KeyFrameId first{0, 1};
  int lonely = 0;
  for (int k = 0; k < 200 && lonely < 3; ++k) {  // points that one keyframe sees
    const auto i = static_cast<std::size_t>(k);
    if (i >= all.at(first).points.size() || all.at(first).points[i].valid()) continue;
    all.add_point({0, 0, 3}, first, k);
    ++lonely;
  }
  std::size_t seen_once = 0;
  all.points().for_each(
      [&](MapPointId, const MapPoint& p) { seen_once += p.observations.size() < 2 ? 1 : 0; });
  const Result<PrunedMap> pruned = prune_atlas(all, {});
  ASSERT_TRUE(pruned.ok()) << pruned.error().message;
  EXPECT_THAT(pruned->atlas.check_consistency(), IsEmpty());
  EXPECT_EQ(pruned->maps, 1U);
  EXPECT_EQ(pruned->keyframes, 2U);
  EXPECT_GE(pruned->points, seen_once);
  pruned->atlas.points().for_each(
      [](MapPointId, const MapPoint& p) { EXPECT_GE(p.observations.size(), 2U); });
  const Result<PrunedMap> again = prune_atlas(pruned->atlas, {});
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->maps + again->keyframes + again->points, 0U);
}

TEST(PruneAtlas, KeyframesThatHoldNothingTogetherGoButForTheFirst) {
  Atlas all = map_of(9, 1);
  PruneOptions strict;
  strict.min_points = 100000;
  const Result<PrunedMap> pruned = prune_atlas(all, strict);
  ASSERT_TRUE(pruned.ok());
  EXPECT_EQ(pruned->atlas.keyframes().size(), 1U);
  EXPECT_TRUE(pruned->atlas.is_first(pruned->atlas.newest_keyframe()));
  strict.min_keyframes = 1000;  // the largest stays all the same
  EXPECT_TRUE(prune_atlas(all, strict).ok());
}

TEST(PruneAtlas, AnEmptyAtlasIsToldSo) {
  const PointWorld world = make_world(1, 1);
  EXPECT_FALSE(prune_atlas(Atlas(world.camera, world.scales), {}).ok());
}

}  // namespace
}  // namespace ydd
