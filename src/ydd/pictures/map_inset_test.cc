// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/map_inset.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

int count(const ColourImage& picture, auto predicate) {
  int n = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) n += predicate(picture(x, y)) ? 1 : 0;
  }
  return n;
}
bool is_red(const Bgr& c) { return c[2] > 200 && c[1] < 100; }
bool is_green(const Bgr& c) { return c[1] > 180 && c[2] < 100; }
bool is_blue(const Bgr& c) { return c[0] > 200 && c[2] < 100; }

/// A map with one keyframe at the origin, which sees nothing.
struct OneKeyFrame {
  Atlas atlas{Camera{}, PyramidScales::make(8, 1.2)};
  KeyFrameId id;

  OneKeyFrame() {
    KeyFrame keyframe;
    keyframe.shared_features = std::make_shared<const Features>();
    keyframe.map = atlas.new_map();
    id = atlas.add_keyframe(std::move(keyframe));
  }
  FrameReport at(double x_m, double z_m, TrackingState state = TrackingState::tracking) const {
    FrameReport report;
    report.track.state = state;
    report.track.reference = id;
    report.track.T_reference_camera =
        SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, z_m));
    return report;
  }
};

TEST(MapInset, WithoutAMapItIsDark) {
  const OneKeyFrame world;
  const ColourImage picture = MapInset().draw(world.atlas, 80, 60);
  EXPECT_EQ(picture.width(), 80);
  EXPECT_EQ(count(picture, [&](const Bgr& c) { return c != picture(0, 0); }), 0);
}

TEST(MapInset, TheCameraIsAheadOfItsPathAndAheadIsUp) {
  const OneKeyFrame world;
  MapInset map;
  for (int i = 0; i <= 20; ++i) map.add(world.at(0, 0.1 * i));
  const ColourImage picture = map.draw(world.atlas, 120, 90);
  EXPECT_GT(count(picture, is_green), 20);
  EXPECT_GT(count(picture, is_blue), 20);
  EXPECT_EQ(count(picture, is_red), 0);
  int green_y = 0, blue_y = 0, greens = 0, blues = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      if (is_green(picture(x, y))) green_y += y, ++greens;
      if (is_blue(picture(x, y))) blue_y += y, ++blues;
    }
  }
  EXPECT_LT(green_y / greens, blue_y / blues) << "the camera looks along z, which is up";
}

TEST(MapInset, ALostCameraIsRedWhereItWasLast) {
  const OneKeyFrame world;
  MapInset map;
  map.add(world.at(0, 0));
  map.add(world.at(1, 0, TrackingState::lost));
  const ColourImage picture = map.draw(world.atlas, 120, 90);
  EXPECT_GT(count(picture, is_red), 20);
  EXPECT_EQ(count(picture, is_green), 0);
}

}  // namespace
}  // namespace ydd
