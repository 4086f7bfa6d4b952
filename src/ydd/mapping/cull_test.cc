// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/cull.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::hand_held;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::View;
using testing_world::ViewOptions;

/// `n` views from the same place, all points linked.
BuiltMap same_place(int n, const ViewOptions& options = {}) {
  const PointWorld world = make_world(400, 31);
  return build_map(world,
                   std::vector<View>(static_cast<std::size_t>(n), look(world, SE3(), options)));
}

MapPointId lone_point(Atlas& atlas, KeyFrameId id, std::size_t keypoint) {
  atlas.remove_point(atlas.at(id).points[keypoint]);
  return atlas.add_point({0, 0, 2}, id, static_cast<int>(keypoint));
}

TEST(CullRecentPoints, RemovesWhatIsRarelyFound) {
  BuiltMap built = same_place(2);
  Atlas& atlas = built.atlas;
  const MapPointId rare = atlas.at(built.keyframes[0]).points[0];
  const MapPointId fair = atlas.at(built.keyframes[0]).points[1];
  atlas.count_views(rare, 9, 1);  // 2 of 10
  atlas.count_views(fair, 7, 1);  // 2 of 8
  std::vector<MapPointId> recent = {rare, fair};
  EXPECT_EQ(cull_recent_points(atlas, recent, built.keyframes[1], {}), 1);
  EXPECT_EQ(atlas.find(rare), nullptr);
  EXPECT_NE(atlas.find(fair), nullptr);
  EXPECT_THAT(recent, ElementsAre(fair));
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(CullRecentPoints, RemovesWhatNobodyElseSawInTime) {
  BuiltMap built = same_place(4);
  Atlas& atlas = built.atlas;
  const MapPointId old = lone_point(atlas, built.keyframes[1], 0);    // serial 1: age 2
  const MapPointId young = lone_point(atlas, built.keyframes[2], 1);  // age 1
  std::vector<MapPointId> recent = {old, young};
  EXPECT_EQ(cull_recent_points(atlas, recent, built.keyframes[3], {}), 1);
  EXPECT_EQ(atlas.find(old), nullptr);
  EXPECT_THAT(recent, ElementsAre(young));
}

TEST(CullRecentPoints, ForgetsWhatPassedAndWhatIsGone) {
  BuiltMap built = same_place(5);
  Atlas& atlas = built.atlas;
  const MapPointId proven = atlas.at(built.keyframes[0]).points[0];  // age 4, five observations
  const MapPointId gone = atlas.at(built.keyframes[0]).points[1];
  atlas.remove_point(gone);
  std::vector<MapPointId> recent = {proven, gone};
  EXPECT_EQ(cull_recent_points(atlas, recent, built.keyframes[4], {}), 0);
  EXPECT_TRUE(recent.empty());
  EXPECT_NE(atlas.find(proven), nullptr);
}

TEST(CullContradictedPoints, RemovesExactlyThoseContradictedForLong) {
  BuiltMap built = same_place(2);
  Atlas& atlas = built.atlas;
  const std::vector<MapPointId> points = atlas.at(built.keyframes[0]).points;
  CullOptions options;
  options.contradicted_frames = 5;
  const MapPointId gone = points[3];
  atlas.remove_point(gone);
  const std::vector<PointViews> views = {{points[0], 9, 9, 4},
                                         {points[1], 9, 9, 5},
                                         {points[2], 9, 0, 0},
                                         {gone, 9, 9, 8},
                                         {points[4], 1, 0, 9}};
  EXPECT_EQ(cull_contradicted_points(atlas, views, options), 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(atlas.find(points[i]) == nullptr, i == 1 || i == 3 || i == 4) << i;
  }
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(CullRedundantKeyframes, LeavesEnoughOfThemAndAlwaysTheFirst) {
  BuiltMap built = same_place(8);
  const int culled = cull_redundant_keyframes(built.atlas, built.keyframes[7], {});
  EXPECT_EQ(culled, 5);  // until no point is seen from three others any more
  EXPECT_EQ(built.atlas.keyframes().size(), 3U);
  EXPECT_NE(built.atlas.find(built.keyframes[0]), nullptr);
  EXPECT_NE(built.atlas.find(built.keyframes[7]), nullptr) << "the newest is not judged";
  EXPECT_THAT(built.atlas.check_consistency(), IsEmpty());
}

TEST(CullRedundantKeyframes, KeepsThoseWithPointsOfTheirOwn) {
  const PointWorld world = make_world(600, 31);
  std::vector<View> views;
  for (int i = 0; i < 6; ++i) {
    ViewOptions options;  // a third is shared with nobody near enough
    options.from_point = 60 * i;
    options.points = 200;
    views.push_back(look(world, hand_held(0.05 * i), options));
  }
  BuiltMap built = build_map(world, views);
  EXPECT_EQ(cull_redundant_keyframes(built.atlas, built.keyframes[5], {}), 0);
}

TEST(CullRedundantKeyframes, OnlyNearPointsCount) {
  ViewOptions options;
  options.depth_reading_m = 0;  // no reading at all: nothing can be said
  BuiltMap built = same_place(8, options);
  EXPECT_EQ(cull_redundant_keyframes(built.atlas, built.keyframes[7], {}), 0);
}

/// Views from one place, each on a visit of its own and with points of its own.
struct Visits {
  PointWorld world = make_world(900, 31);
  Atlas atlas{world.camera, world.scales};
  std::vector<KeyFrameId> keyframes;
  explicit Visits(int n, double apart_s = 3600.0) {
    const MapId map = atlas.new_map();
    for (int v = 0; v < n; ++v) {
      ViewOptions options;
      options.points = 500;
      const View view = look(world, hand_held(0.02 * v), options);
      KeyFrame keyframe = testing_world::keyframe_of(view, v);
      keyframe.map = map;
      keyframe.stamp.ns += static_cast<std::int64_t>(apart_s * 1e9) * v;
      const KeyFrameId id = atlas.add_keyframe(std::move(keyframe));
      for (std::size_t k = 0; k < view.shown.size(); ++k) link(view, k, id);
      atlas.refresh_covisibility(id, 15);
      keyframes.push_back(id);
    }
  }
  /// Every third point is shared by all views.
  void link(const View& view, std::size_t k, KeyFrameId id) {
    const int shown = view.shown[k];
    const Eigen::Vector3d p_world(0.01 * shown, 0, 3);
    if (shown % 3 != 0) {
      atlas.add_point(p_world, id, static_cast<int>(k));
      return;
    }
    const auto known = shared.find(shown);
    if (known == shared.end()) {
      shared[shown] = atlas.add_point(p_world, id, static_cast<int>(k));
    } else {
      atlas.add_observation(known->second, id, static_cast<int>(k));
    }
  }
  void count_own_points(std::size_t keyframe, int visible, int found) {
    const std::vector<MapPointId> points = atlas.at(keyframes[keyframe]).points;
    for (const MapPointId id : points) {
      if (id.valid() && atlas.at(id).observations.size() == 1) {
        atlas.count_views(id, visible, found);
      }
    }
  }
  std::map<int, MapPointId> shared;
};

TEST(CullCrowdedPlace, TheLeastUsefulOfEarlierVisitsGo) {
  Visits visits(7);
  for (std::size_t i = 0; i < 7; ++i) visits.count_own_points(i, 100, i == 3 || i == 4 ? 1 : 90);
  CullOptions options;
  options.place_keyframes = 5;
  EXPECT_EQ(cull_crowded_place(visits.atlas, visits.keyframes[6], options), 2);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(visits.atlas.find(visits.keyframes[i]) == nullptr, i == 3 || i == 4) << i;
  }
  EXPECT_THAT(visits.atlas.check_consistency(), IsEmpty());
}

TEST(CullCrowdedPlace, TheFirstOfTheMapAndThoseOfThisVisitStay) {
  Visits visits(7);
  CullOptions options;
  options.place_keyframes = 1;
  EXPECT_EQ(cull_crowded_place(visits.atlas, visits.keyframes[6], options), 5);
  EXPECT_NE(visits.atlas.find(visits.keyframes[0]), nullptr);
  EXPECT_NE(visits.atlas.find(visits.keyframes[6]), nullptr);
  EXPECT_THAT(visits.atlas.check_consistency(), IsEmpty());
}

TEST(CullCrowdedPlace, OneVisitHasNoBudget) {
  Visits visits(9, 0.1);
  EXPECT_EQ(cull_crowded_place(visits.atlas, visits.keyframes[8], {}), 0);
}

TEST(CullCrowdedPlace, OtherPlacesAreLeftAlone) {
  Visits visits(7);
  CullOptions options;
  options.place_radius_m = 0;
  EXPECT_EQ(cull_crowded_place(visits.atlas, visits.keyframes[6], options), 0);
}

}  // namespace
}  // namespace ydd
