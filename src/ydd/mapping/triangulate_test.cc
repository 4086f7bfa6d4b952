// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/triangulate.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::View;
using testing_world::ViewOptions;

SE3 sideways(double x_m) { return {Eigen::Quaterniond::Identity(), {x_m, 0, 0}}; }

/// Two views `baseline_m` apart; the map knows every other point.
struct HalfKnown {
  PointWorld world = make_world(1000, 12);
  std::vector<View> views;
  BuiltMap built;

  HalfKnown(double baseline_m, const ViewOptions& options)
      : views(look_twice(baseline_m, options)), built(build_map(world, views)) {
    for (std::size_t i = 0; i < built.points.size(); i += 2) {
      if (built.points[i].valid()) built.atlas.remove_point(built.points[i]);
    }
    built.atlas.refresh_covisibility(built.keyframes[1], 15);
  }
  std::vector<View> look_twice(double baseline_m, ViewOptions options) const {
    std::vector<View> out = {look(world, SE3(), options)};
    ++options.seed;
    out.push_back(look(world, sideways(baseline_m), options));
    return out;
  }
  /// World point behind an observation.
  std::size_t shown(const Observation& s) const {
    const std::size_t view = s.keyframe == built.keyframes[0] ? 0 : 1;
    return static_cast<std::size_t>(views[view].shown[static_cast<std::size_t>(s.keypoint)]);
  }
  std::vector<MapPointId> triangulate() {
    return triangulate_with_neighbours(built.atlas, built.keyframes[1], {}, {});
  }
  double error_m(MapPointId id) const {
    const MapPoint& point = built.atlas.at(id);
    return (point.p_world - world.p_world[shown(point.observations.front())]).norm();
  }
};

ViewOptions without_depth() {
  ViewOptions options;
  options.depth_reading_m = 0;
  return options;
}

TEST(Triangulate, ExactPixelsGiveExactPoints) {
  HalfKnown half(0.3, without_depth());
  const auto created = half.triangulate();
  EXPECT_GT(created.size(), 60U);
  for (const MapPointId id : created) {
    const MapPoint& point = half.built.atlas.at(id);
    ASSERT_EQ(point.observations.size(), 2U);
    EXPECT_EQ(half.shown(point.observations[0]), half.shown(point.observations[1]));
    EXPECT_LT(half.error_m(id), 0.001);
  }
  EXPECT_THAT(half.built.atlas.check_consistency(), testing::IsEmpty());
}

TEST(Triangulate, NoiseMovesPointsAsMuchAsTheBaselineTells) {
  ViewOptions options = without_depth();
  options.noise_px = 0.3;
  options.flipped_bits = 10;
  HalfKnown half(0.3, options);
  const auto created = half.triangulate();
  ASSERT_GT(created.size(), 40U);
  std::vector<double> errors_m;
  for (const MapPointId id : created) errors_m.push_back(half.error_m(id));
  std::sort(errors_m.begin(), errors_m.end());
  // One pixel of disparity at 4 m over 0.3 m is 10 cm.
  EXPECT_LT(errors_m[errors_m.size() / 2], 0.08);
}

TEST(Triangulate, DepthOfEitherViewIsUsedWhereThereIs) {
  HalfKnown half(0.1, ViewOptions{});
  const auto created = half.triangulate();
  ASSERT_GT(created.size(), 60U);
  for (const MapPointId id : created) EXPECT_LT(half.error_m(id), 0.03);
}

TEST(Triangulate, NeedsABaselineAndAnAngle) {
  HalfKnown near(0.04, without_depth());
  EXPECT_TRUE(near.triangulate().empty());
  HalfKnown narrow(0.06, without_depth());
  const auto created = narrow.triangulate();
  EXPECT_GT(created.size(), 10U);
  for (const MapPointId id : created) {
    // Cosine 0.9998 is 0.02 rad: nothing farther than 3 m.
    EXPECT_LT(narrow.built.atlas.at(id).p_world.norm(), 3.1);
  }
}

TEST(Triangulate, WithoutNeighboursNothing) {
  HalfKnown half(0.3, without_depth());
  const auto ids = half.built.atlas.points().ids();
  for (const MapPointId id : ids) half.built.atlas.remove_point(id);
  half.built.atlas.refresh_covisibility(half.built.keyframes[1], 15);
  EXPECT_TRUE(half.triangulate().empty());
}

}  // namespace
}  // namespace ydd
