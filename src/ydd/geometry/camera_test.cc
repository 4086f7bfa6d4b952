// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/camera.h"

#include <cmath>

#include <gtest/gtest.h>

namespace ydd {
namespace {

/// The colour camera of TUM's fr1 sequences: the strongest distortion among the common ones.
Camera fr1() {
  Camera c;
  c.fx_px = 517.306408;
  c.fy_px = 516.469215;
  c.cx_px = 318.643040;
  c.cy_px = 255.313989;
  c.k1 = 0.262383;
  c.k2 = -0.953104;
  c.p1 = -0.005358;
  c.p2 = 0.002628;
  c.k3 = 1.163314;
  return c;
}

TEST(Camera, ValuesThatNoRealOneHasAreTold) {
  EXPECT_TRUE(check_camera(Camera()));
  EXPECT_TRUE(check_camera(fr1()));
  const auto is_refused = [](double Camera::*value, double to) {
    Camera c = fr1();
    c.*value = to;
    return !check_camera(c);
  };
  for (const auto value :
       {&Camera::fx_px, &Camera::fy_px, &Camera::cx_px, &Camera::cy_px, &Camera::k1, &Camera::k3,
        &Camera::p2, &Camera::depth_scale, &Camera::min_depth_m, &Camera::max_depth_m, &Camera::fps,
        &Camera::baseline_m}) {
    for (const double to : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e7, -1e7}) {
      EXPECT_TRUE(is_refused(value, to)) << to;
    }
  }
  EXPECT_TRUE(is_refused(&Camera::cx_px, 640));
  EXPECT_TRUE(is_refused(&Camera::cy_px, -0.5));
  EXPECT_TRUE(is_refused(&Camera::fx_px, 250));
  EXPECT_TRUE(is_refused(&Camera::max_depth_m, 0.1));
  Camera huge;
  huge.width_px = 1 << 30;
  EXPECT_FALSE(check_camera(huge));
}

TEST(Camera, ProjectsAndUnprojects) {
  const Camera c = fr1();
  const Eigen::Vector3d p(0.3, -0.2, 1.7);
  const Eigen::Vector2d px = c.project(p);
  EXPECT_NEAR(px.x(), 517.306408 * 0.3 / 1.7 + 318.643040, 1e-12);
  EXPECT_NEAR(px.y(), 516.469215 * -0.2 / 1.7 + 255.313989, 1e-12);
  EXPECT_LT((c.unproject(px, 1.7) - p).norm(), 1e-12);
  EXPECT_LT((c.project({0, 0, 2}) - Eigen::Vector2d(c.cx_px, c.cy_px)).norm(), 1e-12);
}

TEST(Camera, RightAndDownAreGrowingPixels) {
  const Camera c;
  EXPECT_GT(c.project({0.1, 0, 1}).x(), c.cx_px);
  EXPECT_GT(c.project({0, 0.1, 1}).y(), c.cy_px);
}

TEST(Camera, WithoutDistortionPixelsStay) {
  const Camera c;
  EXPECT_FALSE(c.has_distortion());
  const Eigen::Vector2d px(12.25, 400.5);
  EXPECT_EQ(c.distort(px), px);
  EXPECT_EQ(c.undistort(px), px);
}

TEST(Camera, UndistortUndoesDistortEverywhereInTheImage) {
  const Camera c = fr1();
  ASSERT_TRUE(c.has_distortion());
  for (int v = 0; v < c.height_px; v += 10) {
    for (int u = 0; u < c.width_px; u += 10) {
      const Eigen::Vector2d image_px(u, v);
      EXPECT_LT((c.distort(c.undistort(image_px)) - image_px).norm(), 1e-6) << u << ", " << v;
    }
  }
}

TEST(Camera, DistortsByTheKnownFormula) {
  // One coefficient at a time, at normalised (0.5, 0.2): r^2 = 0.29.
  const auto distorted = [](auto set) {
    Camera c;
    c.fx_px = c.fy_px = 1000.0;
    c.cx_px = c.cy_px = 0.0;
    set(c);
    return Eigen::Vector2d(c.distort({500.0, 200.0}) / 1000.0);
  };
  const Eigen::Vector2d xy(0.5, 0.2);
  const double r2 = 0.29;
  EXPECT_LT((distorted([](Camera& c) { c.k1 = 0.1; }) - xy * (1 + 0.1 * r2)).norm(), 1e-12);
  EXPECT_LT((distorted([](Camera& c) { c.k2 = 0.1; }) - xy * (1 + 0.1 * r2 * r2)).norm(), 1e-12);
  EXPECT_LT((distorted([](Camera& c) { c.k3 = 0.1; }) - xy * (1 + 0.1 * r2 * r2 * r2)).norm(),
            1e-12);
  const Eigen::Vector2d by_p1(2 * 0.1 * 0.5 * 0.2, 0.1 * (r2 + 2 * 0.2 * 0.2));
  EXPECT_LT((distorted([](Camera& c) { c.p1 = 0.1; }) - xy - by_p1).norm(), 1e-12);
  const Eigen::Vector2d by_p2(0.1 * (r2 + 2 * 0.5 * 0.5), 2 * 0.1 * 0.5 * 0.2);
  EXPECT_LT((distorted([](Camera& c) { c.p2 = 0.1; }) - xy - by_p2).norm(), 1e-12);
}

TEST(Camera, KnowsValidDepths) {
  Camera c;
  c.min_depth_m = 0.5;
  c.max_depth_m = 4.0;
  EXPECT_TRUE(c.is_valid_depth(0.5));
  EXPECT_TRUE(c.is_valid_depth(4.0));
  EXPECT_FALSE(c.is_valid_depth(0.0));
  EXPECT_FALSE(c.is_valid_depth(0.49));
  EXPECT_FALSE(c.is_valid_depth(4.01));
  EXPECT_FALSE(c.is_valid_depth(std::nan("")));
}

TEST(Camera, DescribesItselfWithinItsRanges) {
  Camera c;
  OptionTable table;
  c.describe(table);
  for (const Option& option : table.options()) {
    EXPECT_TRUE(table.set(option.key, format_value(option), "default")) << option.key;
    EXPECT_FALSE(option.sentence.empty()) << option.key;
  }
  EXPECT_TRUE(table.set("fx", "600", "test"));
  EXPECT_TRUE(table.set("baseline", "0.1", "test"));
  EXPECT_NEAR(c.bf(), 60.0, 1e-12);
  EXPECT_FALSE(table.set("fx", "0", "test"));
}

}  // namespace
}  // namespace ydd
