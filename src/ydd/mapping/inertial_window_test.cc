// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/inertial_window.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ydd/reckoning/carried_sensor_testing.h"

namespace ydd {
namespace {

using carried_sensor::at;
using carried_sensor::path;
using carried_sensor::speed_m_s;

const Eigen::Vector3d kDown(0, 0, -9.81);
const carried_sensor::Faults kCheapImu{{0.01, -0.02, 0.015}, {0.1, -0.1, 0.15}, 0.004, 0.02, 7};

/// Keyframes that see nothing, at true poses; the IMU is where the camera is.
struct CarriedWindow {
  Atlas atlas{Camera(), PyramidScales::make(8, 1.2)};
  MapId map = atlas.new_map();
  InertialWindow window;
  std::vector<ImuSample> samples = carried_sensor::imu(0.0, 30.0, kCheapImu);
  std::vector<KeyFrameId> keyframes;
  double last_s = -1;

  explicit CarriedWindow(int most = 12) : window(options(most)) {}
  static InertialOptions options(int most) {
    InertialOptions options;
    options.enabled = true;
    options.keyframes = most;
    return options;
  }
  KeyFrameId enter(double t_s, bool in_new_map = false) {
    if (in_new_map) map = atlas.new_map();
    KeyFrame keyframe;
    keyframe.map = map;
    keyframe.stamp = at(t_s);
    keyframe.T_world_camera = path(t_s);
    keyframe.shared_features = std::make_shared<const Features>();
    const KeyFrameId id = atlas.add_keyframe(std::move(keyframe));
    if (!keyframes.empty() && !in_new_map) atlas.set_parent(id, keyframes.back());
    keyframes.push_back(id);
    std::vector<ImuSample> fresh;
    std::copy_if(samples.begin(), samples.end(), std::back_inserter(fresh),
                 [&](const auto& s) { return s.stamp > at(last_s) && s.stamp <= at(t_s); });
    window.enter(atlas, id, fresh);
    last_s = t_s;
    return id;
  }
  void walk(int count, double every_s = 0.4) {
    for (int i = 0; i < count; ++i) enter(keyframes.empty() ? 0.5 : last_s + every_s);
  }
  GatheredBundle bundle() const {
    GatheredBundle out;
    out.keyframes = keyframes;
    return out;
  }
};

double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
}

TEST(InertialWindow, LearnsGravityBiasesAndSpeedsFromWhereItWasSeen) {
  CarriedWindow w;
  w.walk(4);
  EXPECT_FALSE(w.window.knows_gravity());
  EXPECT_TRUE(w.window.keyframes().empty()) << "until then bundles are those of vision alone";
  EXPECT_FALSE(w.window.problem(w.bundle()));
  w.walk(5);
  ASSERT_TRUE(w.window.knows_gravity());
  EXPECT_EQ(w.window.keyframes().size(), 9U);
  const auto problem = w.window.problem(w.bundle());
  ASSERT_TRUE(problem.has_value());
  ASSERT_EQ(problem->links.size(), 8U);
  EXPECT_EQ(problem->links[3].from, 3);
  EXPECT_EQ(problem->links[3].to, 4);
  EXPECT_NEAR(problem->links[3].measured.sum.duration_s, 0.4, 1e-9);
  EXPECT_LT(angle_rad(problem->start.gravity_m_s2, kDown), 0.03);
  EXPECT_LT((problem->start.gyro_bias_rad_s - kCheapImu.gyro_bias_rad_s).norm(), 0.005);
  for (std::size_t i = 0; i < 9; ++i) {
    const double t_s = 0.5 + 0.4 * static_cast<double>(i);
    EXPECT_LT((problem->start.speed_m_s[i] - speed_m_s(t_s)).norm(), 0.15) << i;
  }
}

TEST(InertialWindow, ALinkReachesOverACulledKeyframe) {
  CarriedWindow w;
  w.walk(8);
  w.atlas.cull_keyframe(w.keyframes[6]);
  w.keyframes.erase(w.keyframes.begin() + 6);
  w.enter(w.last_s + 0.4);
  const auto problem = w.window.problem(w.bundle());
  ASSERT_TRUE(problem.has_value());
  ASSERT_EQ(problem->links.size(), 7U);
  EXPECT_NEAR(problem->links[5].measured.sum.duration_s, 0.8, 1e-9);
  const auto whole = preintegrate(w.samples, at(0.5 + 5 * 0.4), at(0.5 + 7 * 0.4),
                                  problem->start.gyro_bias_rad_s, problem->start.accel_bias_m_s2);
  EXPECT_LT((whole->shift_m - problem->links[5].measured.sum.shift_m).norm(), 1e-3);
}

TEST(InertialWindow, HoldsTheNewestOnly) {
  CarriedWindow w(6);
  w.walk(20);
  const std::vector<KeyFrameId> newest(w.keyframes.end() - 6, w.keyframes.end());
  EXPECT_EQ(w.window.keyframes(), newest);
  EXPECT_EQ(w.window.problem(w.bundle())->links.size(), 5U);
}

TEST(InertialWindow, BeginsAnewInAnotherMapAndAfterALongPause) {
  CarriedWindow w;
  w.walk(8);
  w.enter(w.last_s + 12.0);
  EXPECT_TRUE(w.window.knows_gravity()) << "the same world";
  EXPECT_EQ(w.window.keyframes().size(), 1U);
  EXPECT_FALSE(w.window.problem(w.bundle()));
  w.walk(1);
  const auto problem = w.window.problem(w.bundle());
  ASSERT_TRUE(problem.has_value());
  EXPECT_LT((problem->start.speed_m_s.back() - speed_m_s(w.last_s)).norm(), 0.2);
  w.enter(w.last_s + 0.4, true);
  EXPECT_FALSE(w.window.knows_gravity()) << "of that world nothing is known";
}

TEST(InertialWindow, TurnsWithTheMap) {
  CarriedWindow w;
  w.walk(8);
  const auto before = w.window.problem(w.bundle());
  const SE3 T_new_old(so3_exp({0.3, -0.2, 1.0}), {1, 2, 3});
  const auto rotations = w.window.rotations(w.atlas);
  for (const KeyFrameId id : w.keyframes) {
    w.atlas.set_pose(id, T_new_old * w.atlas.at(id).T_world_camera);
  }
  w.window.turned(rotations, w.atlas);
  const auto after = w.window.problem(w.bundle());
  ASSERT_TRUE(before && after);
  EXPECT_LT((after->start.gravity_m_s2 - T_new_old.rotation() * before->start.gravity_m_s2).norm(),
            1e-9);
  EXPECT_LT((after->start.speed_m_s[4] - T_new_old.rotation() * before->start.speed_m_s[4]).norm(),
            1e-9);
}

TEST(InertialWindow, LearnsNothingFromAnImuThatIsMountedOtherwise) {
  CarriedWindow w;
  for (ImuSample& s : w.samples) {
    s.gyro_rad_s = Eigen::Vector3d(s.gyro_rad_s.z(), s.gyro_rad_s.x(), s.gyro_rad_s.y());
    s.accel_m_s2 = Eigen::Vector3d(s.accel_m_s2.z(), s.accel_m_s2.x(), s.accel_m_s2.y());
  }
  w.walk(20);
  EXPECT_FALSE(w.window.knows_gravity());
}

TEST(InertialWindow, WithoutSamplesThereAreNoLinks) {
  CarriedWindow w;
  w.samples.clear();
  w.walk(10);
  EXPECT_FALSE(w.window.knows_gravity());
  EXPECT_FALSE(w.window.problem(w.bundle()));
}

}  // namespace
}  // namespace ydd
