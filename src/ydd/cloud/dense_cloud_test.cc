// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/dense_cloud.h"

#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/cloud/keyframe_picture.h"
#include "ydd/cloud/ply.h"
#include "ydd/map/join_atlases.h"
#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

namespace tw = testing_world;

/// A wall at z = 3 m of the world; with `ghost` something stands at 1.5 m that nobody detected.
PictureSource wall_picture(const Camera& camera, double camera_z_m, bool ghost) {
  std::vector<float> depth_m;
  std::vector<Bgr> colour;
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      const bool hidden = ghost && x > 250 && x < 350 && y > 200 && y < 300;
      depth_m.push_back(hidden ? 1.5F : static_cast<float>(3.0 - camera_z_m));
      colour.push_back(hidden ? Bgr{0, 0, 255} : Bgr{200, 200, 200});
    }
  }
  return {ColourImage(camera.width_px, camera.height_px, std::move(colour)),
          DepthImage(camera.width_px, camera.height_px, std::move(depth_m)),
          {}};
}

struct Scene {
  Atlas atlas;
  MapId map;
};

/// Seen by a camera that moves sideways; `ghost_in` tells of each picture whether the thing is
/// there.
Scene walls_scene(const std::vector<bool>& ghost_in, bool distorted = false, bool looked = false) {
  tw::PointWorld world = tw::make_world(300, 5);
  if (distorted) {
    world.camera.k1 = 0.1;
    world.camera.p1 = 0.001;
  }
  std::vector<tw::View> views;
  for (std::size_t i = 0; i < ghost_in.size(); ++i) {
    views.push_back(tw::look(
        world, SE3(Eigen::Quaterniond::Identity(), {0.05 * static_cast<double>(i), 0, 0})));
  }
  Scene scene{Atlas(world.camera, world.scales), {}};
  scene.map = scene.atlas.new_map();
  std::vector<MapPointId> points(world.p_world.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    KeyFrame keyframe = tw::keyframe_of(views[v], static_cast<std::int64_t>(v));
    keyframe.map = scene.map;
    PictureSource source = wall_picture(world.camera, 0, ghost_in[v]);
    source.looked = looked;
    keyframe.picture = std::make_shared<const KeyFramePicture>(make_keyframe_picture(source));
    const KeyFrameId id = scene.atlas.add_keyframe(std::move(keyframe));
    for (std::size_t k = 0; k < views[v].shown.size(); ++k) {
      MapPointId& point = points[static_cast<std::size_t>(views[v].shown[k])];
      if (point.valid()) {
        scene.atlas.add_observation(point, id, static_cast<int>(k));
      } else {
        point = scene.atlas.add_point({0, 0, 3}, id, static_cast<int>(k));
      }
    }
    scene.atlas.refresh_covisibility(id, 15);
  }
  return scene;
}

Scene wall_scene(bool ghost, bool distorted = false) {
  return walls_scene({false, false, ghost, false}, distorted);
}

std::ptrdiff_t near_points(const Scene& scene, const DenseCloudOptions& options) {
  const auto cloud = dense_cloud(scene.atlas, scene.map, options).value();
  return std::count_if(cloud.begin(), cloud.end(),
                       [](const CloudPoint& p) { return p.p_world.z() < 2.5F; });
}

TEST(DenseCloud, IsTheSurfaceThatWasSeen) {
  for (const bool distorted : {false, true}) {
    const Scene scene = wall_scene(false, distorted);
    const auto cloud = dense_cloud(scene.atlas, scene.map, {0.05, 4.0, 6}).value();
    EXPECT_GT(cloud.size(), 2000U);
    for (const CloudPoint& point : cloud) {
      ASSERT_NEAR(point.p_world.z(), 3.0F, 0.01F);
      ASSERT_NEAR(point.colour[0], 200, 8);
    }
  }
}

TEST(DenseCloud, WhatOthersLookThroughIsDropped) {
  const Scene scene = wall_scene(true);
  EXPECT_GT(near_points(scene, {0.05, 4.0, 0, 0}), 10);
  EXPECT_EQ(near_points(scene, {0.05, 4.0, 6, 0}), 0);
}

TEST(DenseCloud, WhatIsGoneOnALaterVisitIsDropped) {
  const Scene taken_away = walls_scene({true, true, true, true, true, false, false});
  EXPECT_GT(near_points(taken_away, {0.05, 4.0, 6, 0}), 10);
  EXPECT_EQ(near_points(taken_away, {}), 0);
}

TEST(DenseCloud, WhatOnePictureDoesNotShowAtTheEndStays) {
  EXPECT_GT(near_points(walls_scene({true, true, true, true, true, false}), {}), 10);
}

TEST(DenseCloud, WhatHasComeStays) {
  EXPECT_GT(near_points(walls_scene({false, false, true, true, true, true, true}), {}), 10);
}

TEST(DenseCloud, FartherReadingsThanAskedForAreLeftOut) {
  const Scene scene = wall_scene(false);
  EXPECT_TRUE(dense_cloud(scene.atlas, scene.map, {0.05, 2.0, 6}).value().empty());
  EXPECT_TRUE(dense_cloud(scene.atlas, {7, 1}, {}).value().empty());  // another map
}

TEST(DenseCloud, RedactedItHasColourOnlyWhereSomebodyLookedForPeople) {
  DenseCloudOptions options;
  const auto colours = [&](bool looked) {
    const Scene scene = walls_scene({false, false}, false, looked);
    std::set<Bgr> out;
    for (const CloudPoint& p : dense_cloud(scene.atlas, scene.map, options).value()) {
      out.insert(p.colour);
    }
    return out;
  };
  const Bgr grey = {128, 128, 128};
  EXPECT_FALSE(colours(false).contains(grey));
  options.redact = true;
  EXPECT_EQ(colours(false), std::set<Bgr>{grey});
  EXPECT_FALSE(colours(true).contains(grey));
}

TEST(DenseCloud, TwiceTheSameBytes) {
  const Scene scene = wall_scene(true);
  const auto ply = [&] { return format_ply(dense_cloud(scene.atlas, scene.map, {}).value()); };
  EXPECT_EQ(ply(), ply());
}

TEST(Ply, HoldsPointsAndColours) {
  const std::vector<CloudPoint> points = {{{1.0F, 2.0F, 3.0F}, {10, 20, 30}},
                                          {{-1.0F, 0.0F, 0.5F}, {1, 2, 3}}};
  const std::string ply = format_ply(points);
  EXPECT_THAT(ply, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(ply, testing::HasSubstr("element vertex 2\n"));
  const std::string body = ply.substr(ply.find("end_header\n") + 11);
  ASSERT_EQ(body.size(), 2U * 15U);
  EXPECT_EQ(body.substr(0, 4), std::string("\0\0\x80\x3f", 4));
  EXPECT_EQ(body.substr(12, 3), "\x1e\x14\x0a");  // red first
}

TEST(Ply, TheSparseCloudIsThatOfOneMap) {
  Scene scene = wall_scene(false);
  const std::string ply = format_sparse_ply(scene.atlas, scene.map);
  EXPECT_THAT(ply,
              testing::HasSubstr(fmt::format("element vertex {}\n", scene.atlas.points().size())));
  EXPECT_EQ(ply.size() - ply.find("end_header\n") - 11, scene.atlas.points().size() * 28U);
  EXPECT_THAT(format_sparse_ply(scene.atlas, {9, 1}), testing::HasSubstr("element vertex 0\n"));
}

TEST(JoinAtlases, KeepsBothApart) {
  Scene a = wall_scene(false);
  Scene b = wall_scene(true);
  b.atlas.cull_keyframe(b.atlas.keyframes().ids()[1]);
  const Result<Atlas> joined = join_atlases(a.atlas, b.atlas);
  ASSERT_TRUE(joined.ok()) << joined.error().message;
  EXPECT_THAT(joined->check_consistency(), testing::IsEmpty());
  EXPECT_EQ(joined->keyframes().size(), 7U);
  EXPECT_EQ(joined->points().size(), a.atlas.points().size() + b.atlas.points().size());
  EXPECT_EQ(joined->maps(), 2U);
  EXPECT_EQ(joined->culled().size(), 1U);
  for (const KeyFrameId id : a.atlas.keyframes().ids()) {
    EXPECT_EQ(joined->at(id).serial, a.atlas.at(id).serial);
    EXPECT_EQ(joined->at(id).points, a.atlas.at(id).points);
  }
}

TEST(JoinAtlases, AnotherCameraIsAFailure) {
  const Scene a = wall_scene(false);
  const Scene b = wall_scene(false, true);
  EXPECT_FALSE(join_atlases(a.atlas, b.atlas).ok());
}

}  // namespace
}  // namespace ydd
