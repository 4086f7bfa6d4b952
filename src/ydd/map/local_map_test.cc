// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/local_map.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::hand_held;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::View;
using testing_world::ViewOptions;

/// Keyframe `i` sees points [50 i, 50 i + 100): each shares half of its points with the next.
BuiltMap chain_of(int keyframes) {
  const PointWorld world = make_world(50 * keyframes + 50, 5);
  std::vector<View> views;
  for (int i = 0; i < keyframes; ++i) {
    ViewOptions options;
    options.from_point = 50 * i;
    options.points = 100;
    views.push_back(look(world, hand_held(0.1 * i, 0.05), options));
  }
  return build_map(world, views, 1);
}

std::vector<MapPointId> points_of(const BuiltMap& built, std::size_t keyframe) {
  std::vector<MapPointId> out;
  for (const MapPointId id : built.atlas.at(built.keyframes[keyframe]).points) {
    if (id.valid()) out.push_back(id);
  }
  return out;
}

TEST(LocalMap, MostSharedKeyframeIsTheOneThatSeesMost) {
  BuiltMap built = chain_of(5);
  EXPECT_EQ(most_shared_keyframe(built.atlas, points_of(built, 2)), built.keyframes[2]);
  EXPECT_FALSE(most_shared_keyframe(built.atlas, {}).valid());
  const MapPointId gone = points_of(built, 0).front();
  built.atlas.remove_point(gone);
  EXPECT_FALSE(most_shared_keyframe(built.atlas, std::vector{gone}).valid());
}

TEST(LocalMap, TiesGoToTheNewest) {
  const PointWorld world = make_world(100, 5);
  const View view = look(world, SE3());
  const BuiltMap built = build_map(world, {view, view, view});
  EXPECT_EQ(most_shared_keyframe(built.atlas, points_of(built, 0)), built.keyframes[2]);
}

TEST(LocalMap, HoldsThoseThatSeeThePointsThenTheirNeighboursAndAllTheirPointsOnce) {
  const BuiltMap built = chain_of(7);
  const LocalMap local = gather_local_map(built.atlas, points_of(built, 3), {}, 80);
  EXPECT_EQ(local.revision, built.atlas.revision());
  EXPECT_EQ(local.reference, built.keyframes[3]);
  ASSERT_EQ(local.keyframes.size(), 5U);
  EXPECT_EQ(local.keyframes[0], built.keyframes[3]);
  EXPECT_THAT(std::vector(local.keyframes.begin() + 1, local.keyframes.begin() + 3),
              testing::UnorderedElementsAre(built.keyframes[2], built.keyframes[4]));
  EXPECT_THAT(std::vector(local.keyframes.begin() + 3, local.keyframes.end()),
              testing::UnorderedElementsAre(built.keyframes[1], built.keyframes[5]));
  std::set<MapPointId> expected;
  for (const std::size_t k : {1U, 2U, 3U, 4U, 5U}) {
    for (const MapPointId id : points_of(built, k)) expected.insert(id);
  }
  std::set<MapPointId> got;
  for (const LocalPoint& point : local.points) {
    EXPECT_TRUE(got.insert(point.id).second);
    EXPECT_EQ(point.p_world, built.atlas.at(point.id).p_world);
    EXPECT_EQ(point.descriptor, built.atlas.at(point.id).descriptor);
  }
  EXPECT_EQ(got, expected);
}

TEST(LocalMap, IsLimited) {
  const BuiltMap built = chain_of(7);
  const LocalMap local = gather_local_map(built.atlas, points_of(built, 3), {}, 2);
  EXPECT_EQ(local.keyframes.size(), 2U);
  EXPECT_EQ(local.reference, built.keyframes[3]);
}

TEST(LocalMap, WithoutKnownPointsTheNeighbourhoodOfTheFallback) {
  BuiltMap built = chain_of(7);
  const LocalMap local = gather_local_map(built.atlas, {}, built.keyframes[5], 80);
  EXPECT_EQ(local.reference, built.keyframes[5]);
  EXPECT_THAT(local.keyframes, testing::UnorderedElementsAre(built.keyframes[4], built.keyframes[5],
                                                             built.keyframes[6]));
  built.atlas.cull_keyframe(built.keyframes[5]);
  EXPECT_TRUE(gather_local_map(built.atlas, {}, built.keyframes[5], 80).keyframes.empty());
  EXPECT_TRUE(gather_local_map(built.atlas, {}, {}, 80).points.empty());
}

TEST(LocalMap, TakesTheParentAlsoWhenItSharesNothing) {
  BuiltMap built = chain_of(7);
  built.atlas.set_parent(built.keyframes[6], built.keyframes[0]);
  const LocalMap local = gather_local_map(built.atlas, {}, built.keyframes[6], 80);
  EXPECT_THAT(local.keyframes, testing::Contains(built.keyframes[0]));
}

}  // namespace
}  // namespace ydd
