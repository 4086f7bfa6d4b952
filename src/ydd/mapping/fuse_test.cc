// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/fuse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using testing::IsEmpty;
using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::hand_held;
using testing_world::keyframe_of;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::View;
using testing_world::ViewOptions;

constexpr double kRadius_px = 3.0;

ViewOptions noisy(unsigned seed) {
  ViewOptions options;
  options.noise_px = 0.4;
  options.flipped_bits = 12;
  options.seed = seed;
  return options;
}

/// A map of some views, and one keyframe more that knows nothing, or only duplicates, of it.
struct Newcomer {
  PointWorld world = make_world(800, 21);
  std::vector<View> views = {look(world, hand_held(0.0), noisy(1)),
                             look(world, hand_held(0.2), noisy(2))};
  View view = look(world, hand_held(0.3), noisy(3));
  BuiltMap built = build_map(world, views);
  KeyFrameId id;

  explicit Newcomer(bool duplicates) {
    KeyFrame keyframe = keyframe_of(view, 2);
    keyframe.parent = built.keyframes[1];
    keyframe.map = built.atlas.at(built.keyframes[1]).map;
    id = built.atlas.add_keyframe(keyframe);
    for (std::size_t k = 0; duplicates && k < view.shown.size(); ++k) {
      built.atlas.add_point(world.p_world[static_cast<std::size_t>(view.shown[k])], id,
                            static_cast<int>(k));
    }
  }
  int known_in_view() const {
    int n = 0;
    for (const int i : view.shown) n += built.points[static_cast<std::size_t>(i)].valid() ? 1 : 0;
    return n;
  }
  /// How many keypoints of the newcomer show the right point of the old map.
  int right() const {
    int n = 0;
    const auto& points = built.atlas.at(id).points;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const MapPointId old = built.points[static_cast<std::size_t>(view.shown[k])];
      if (points[k].valid() && points[k] == old) ++n;
    }
    return n;
  }
  int wrong() const {
    int n = 0;
    const auto& points = built.atlas.at(id).points;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!points[k].valid()) continue;
      const MapPoint& point = built.atlas.at(points[k]);
      const auto& truth = world.p_world[static_cast<std::size_t>(view.shown[k])];
      if ((point.p_world - truth).norm() > 1e-9) ++n;
    }
    return n;
  }
};

TEST(FusePoints, LinksKeypointsThatHadNoPoint) {
  Newcomer n(false);
  const auto points = n.built.atlas.points().ids();
  const int fused = fuse_points(n.built.atlas, n.id, points, kRadius_px, {});
  EXPECT_EQ(fused, n.right());
  EXPECT_EQ(n.wrong(), 0);
  EXPECT_GT(n.right(), 0.85 * n.known_in_view());
  EXPECT_EQ(n.built.atlas.points().size(), points.size());
  EXPECT_THAT(n.built.atlas.check_consistency(), IsEmpty());
  EXPECT_EQ(fuse_points(n.built.atlas, n.id, points, kRadius_px, {}), 0) << "a second time";
}

TEST(FusePoints, MergesDuplicatesIntoThePointWithMoreSightings) {
  Newcomer n(true);
  std::vector<MapPointId> old;
  for (const MapPointId id : n.built.points) {
    if (id.valid() && n.built.atlas.at(id).observations.size() == 2) old.push_back(id);
  }
  const std::size_t before = n.built.atlas.points().size();
  const int fused = fuse_points(n.built.atlas, n.id, old, kRadius_px, {});
  EXPECT_GT(fused, 50);
  EXPECT_EQ(n.built.atlas.points().size(), before - static_cast<std::size_t>(fused));
  EXPECT_EQ(n.right(), fused);  // the old ones stay
  EXPECT_EQ(n.wrong(), 0);
  EXPECT_THAT(n.built.atlas.check_consistency(), IsEmpty());
}

TEST(FusePoints, LeavesAlonePointsThatLookDifferentOrLieElsewhere) {
  Newcomer n(false);
  std::mt19937_64 random(5);
  const auto points = n.built.atlas.points().ids();
  for (const MapPointId id : points) {
    n.built.atlas.set_position(id, n.built.atlas.at(id).p_world + Eigen::Vector3d(0.2, -0.2, 0));
  }
  EXPECT_LT(fuse_points(n.built.atlas, n.id, points, kRadius_px, {}), 3);
  // Depth that disagrees, too: half as far again along the ray.
  Newcomer m(false);
  const SE3 T_world_camera = m.view.T_world_camera;
  for (const MapPointId id : m.built.atlas.points().ids()) {
    const Eigen::Vector3d p_camera = T_world_camera.inverse() * m.built.atlas.at(id).p_world;
    m.built.atlas.set_position(id, T_world_camera * Eigen::Vector3d(1.5 * p_camera));
  }
  int with_depth = 0;
  fuse_points(m.built.atlas, m.id, m.built.atlas.points().ids(), kRadius_px, {});
  for (std::size_t k = 0; k < m.view.shown.size(); ++k) {
    if (m.built.atlas.at(m.id).points[k].valid() && m.view.features().has_depth(k)) ++with_depth;
  }
  EXPECT_LT(with_depth, 10);
}

TEST(FuseWithNeighbours, WorksBothWaysAndConnects) {
  Newcomer n(true);
  // The newcomer shares a few points already, so that it has neighbours to fuse with.
  int linked = 0;
  for (std::size_t k = 0; k < n.view.shown.size() && linked < 30; ++k) {
    const MapPointId old = n.built.points[static_cast<std::size_t>(n.view.shown[k])];
    if (!old.valid()) continue;
    n.built.atlas.merge_points(n.built.atlas.at(n.id).points[k], old);
    ++linked;
  }
  n.built.atlas.refresh_covisibility(n.id, 15);
  const int fused = fuse_with_neighbours(n.built.atlas, n.id, 10, kRadius_px, 15, {});
  EXPECT_GT(fused, 50);
  EXPECT_EQ(n.wrong(), 0);
  EXPECT_THAT(n.built.atlas.check_consistency(), IsEmpty());
  ASSERT_FALSE(n.built.atlas.at(n.id).covisible.empty());
  EXPECT_GT(n.built.atlas.at(n.id).covisible.front().weight, 100);
}

}  // namespace
}  // namespace ydd
