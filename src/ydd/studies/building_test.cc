// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/building.h"

#include <cmath>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"
#include "ydd/studies/map_costs.h"

namespace ydd {
namespace {

using namespace testing_world;  // NOLINT(google-build-using-namespace)

/// A mapped room: one that has also culled a keyframe, so that ids have a gap.
std::shared_ptr<const Atlas> room(unsigned seed) {
  const PointWorld world = make_world(400, seed);
  std::vector<View> views;
  for (int i = 0; i < 6; ++i) views.push_back(look(world, hand_held(0.3 * i)));
  BuiltMap built = build_map(world, views);
  built.atlas.cull_keyframe(built.keyframes[3]);
  return built.atlas.snapshot();
}

BuildingOptions small() {
  BuildingOptions options;
  options.keyframes = 60;
  options.revisit_every = 3;
  return options;
}

TEST(Building, IsAConsistentAtlasOfTwoSessions) {
  const std::vector rooms{room(1), room(2)};
  const Building building = grow_building(rooms, small());
  EXPECT_THAT(building.atlas.check_consistency(), testing::IsEmpty());
  EXPECT_GE(building.atlas.keyframes().size(), 60U);
  EXPECT_LE(building.atlas.keyframes().size(), 75U);
  std::set<std::uint32_t> maps;
  building.atlas.keyframes().for_each(
      [&](KeyFrameId, const KeyFrame& k) { maps.insert(k.map.slot); });
  EXPECT_EQ(maps, (std::set<std::uint32_t>{0, 1}));
  ASSERT_FALSE(building.revisits.empty());
  EXPECT_EQ(2 * building.revisits.size() + building.seen_once.size(),
            building.atlas.keyframes().size());
  for (const Revisit& revisit : building.revisits) {
    const KeyFrame& before = building.atlas.at(revisit.before);
    const KeyFrame& again = building.atlas.at(revisit.again);
    EXPECT_EQ(before.map.slot, 0U);
    EXPECT_EQ(again.map.slot, 1U);
    EXPECT_EQ(before.T_world_camera.translation(), again.T_world_camera.translation());
  }
}

/// Median distance of the descriptors of two keyframes of one template.
int median_distance(const Atlas& atlas, KeyFrameId a, KeyFrameId b) {
  std::vector<int> distances;
  const Features& fa = atlas.at(a).features();
  const Features& fb = atlas.at(b).features();
  for (std::size_t i = 0; i < fa.size(); ++i) {
    distances.push_back(hamming_distance(fa.descriptors[i], fb.descriptors[i]));
  }
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

TEST(Building, ARoomLooksTheSameFromEverywhereAndUnlikeItsCopies) {
  const Building building = grow_building({room(1)}, small());
  const Atlas& atlas = building.atlas;
  // A point and each of its observations turn the same tests round.
  atlas.points().for_each([&](MapPointId, const MapPoint& point) {
    const Observation& first = point.observations.front();
    if (atlas.at(first.keyframe).map.slot != 0) return;
    const Features& f = atlas.at(first.keyframe).features();
    EXPECT_LT(
        hamming_distance(point.descriptor, f.descriptors[static_cast<std::size_t>(first.keypoint)]),
        16);
  });
  const std::uint32_t per_room = 5;
  const int copies = median_distance(atlas, {0, 1}, {per_room, 1});
  const Revisit& revisit = building.revisits.front();
  const int days = median_distance(atlas, revisit.before, revisit.again);
  EXPECT_GT(copies, 84);  // 2 * 64 * 3/4
  EXPECT_LT(copies, 108);
  EXPECT_GT(days, 3);
  EXPECT_LT(days, 14);
}

TEST(Building, TheSameSeedGivesTheSameBuildingAndAnotherOneDoesNot) {
  const std::vector rooms{room(1)};
  BuildingOptions other = small();
  other.seed = 2;
  const std::string dump = dump_map(grow_building(rooms, small()).atlas);
  EXPECT_EQ(dump_map(grow_building(rooms, small()).atlas), dump);
  EXPECT_NE(dump_map(grow_building(rooms, other).atlas), dump);
}

TEST(Building, NeedsRooms) {
  EXPECT_THROW(grow_building({}, small()), std::logic_error);
  const auto nothing = std::make_shared<const Atlas>(Camera(), PyramidScales::make(8, 1.2));
  EXPECT_THROW(grow_building({nothing}, small()), std::logic_error);
}

TEST(FittedExponent, IsThePowerOfTheSize) {
  const std::vector<double> sizes{1000, 3000, 10000};
  std::vector<double> quadratic, constant;
  for (const double n : sizes) {
    quadratic.push_back(2e-3 * n * n);
    constant.push_back(7);
  }
  EXPECT_NEAR(fitted_exponent(sizes, quadratic), 2.0, 1e-9);
  EXPECT_NEAR(fitted_exponent(sizes, constant), 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(fitted_exponent({1000}, {1})));
  EXPECT_TRUE(std::isnan(fitted_exponent({1000, 1000}, {1, 2})));
  EXPECT_NEAR(fitted_exponent({10, 0, 100}, {1, 5, 10}), 1.0, 1e-9);  // what is 0 tells nothing
}

}  // namespace
}  // namespace ydd
