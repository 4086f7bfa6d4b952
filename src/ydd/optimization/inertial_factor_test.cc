// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/inertial_factor.h"

#include <gtest/gtest.h>

#include "ydd/optimization/bundle_adjustment.h"
#include "ydd/optimization/bundle_adjustment_ceres.h"
#include "ydd/optimization/synthetic_scene.h"
#include "ydd/reckoning/carried_sensor_testing.h"

namespace ydd {
namespace {

using carried_sensor::at;
using carried_sensor::path;
using carried_sensor::speed_m_s;

constexpr double kEvery_s = 0.25;
const Eigen::Vector3d kGyroBias(0.01, -0.02, 0.015), kAccelBias(0.15, -0.1, 0.2);
const Eigen::Vector3d kDown(0, 0, -9.81);
const SE3 kT_camera_imu(Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5), {0.03, 0.01, -0.02});

SE3 camera_at(double t_s) { return (path(t_s) * kT_camera_imu.inverse()).inverse(); }

struct InertialScene {
  Camera camera;
  BundleProblem truth;  ///< true poses, points and unknowns; noisy observations and samples
};

/// Somebody looks round in a cloud of points: a pose each quarter of a second, the first is fixed.
InertialScene walk_with_imu(int poses, double noise_px, int points = 500) {
  InertialScene scene;
  const auto samples =
      carried_sensor::imu(0.0, (poses + 1) * kEvery_s, {kGyroBias, kAccelBias, 0.004, 0.02, 7});
  InertialProblem inertial;
  inertial.T_camera_imu = kT_camera_imu;
  for (int i = 0; i < poses; ++i) {
    scene.truth.poses.push_back({camera_at(i * kEvery_s), i == 0});
    inertial.start.speed_m_s.push_back(speed_m_s(i * kEvery_s));
    if (i == 0) continue;
    const auto measured = measure_inertial(samples, at((i - 1) * kEvery_s), at(i * kEvery_s),
                                           Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), {});
    inertial.links.push_back({i - 1, i, measured.value()});
  }
  inertial.start.gyro_bias_rad_s = kGyroBias;
  inertial.start.accel_bias_m_s2 = kAccelBias;
  scene.truth.inertial = inertial;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Camera& c = scene.camera;
  for (int p = 0; p < points; ++p) {
    Eigen::Vector3d place(normal(random), normal(random), 0.5 * normal(random));
    place = Eigen::Vector3d(0, 0, 1.4) + 3.0 * place.normalized() + 0.3 * place;
    scene.truth.points.push_back(place);
    for (int i = 0; i < poses; ++i) {
      const Eigen::Vector3d seen = scene.truth.poses[i].T_camera_world * place;
      if (seen.z() < 0.5) continue;
      const Eigen::Vector2d px = c.project(seen);
      if (px.x() < 0 || px.y() < 0 || px.x() >= c.width_px || px.y() >= c.height_px) continue;
      const double u = noise_px * normal(random), v = noise_px * normal(random);
      const double r = noise_px * normal(random);
      scene.truth.observations.push_back(
          {i, p, {px.x() + u, px.y() + v, px.x() - c.bf() / seen.z() + r}, 1.0});
    }
  }
  return scene;
}

/// Nothing known of speeds and biases, gravity a few degrees off.
BundleProblem unlearnt(BundleProblem problem) {
  InertialUnknowns& x = problem.inertial->start;
  for (Eigen::Vector3d& v : x.speed_m_s) v.setZero();
  x.gyro_bias_rad_s.setZero();
  x.accel_bias_m_s2.setZero();
  x.gravity_m_s2 = so3_exp({0.05, -0.08, 0.3}) * kDown;
  problem.inertial->gyro_bias_sigma_rad_s = 0.1;
  problem.inertial->accel_bias_sigma_m_s2 = 1.0;
  problem.inertial->gravity_sigma_rad = 0.5;
  return problem;
}

double worst_place_m(const BundleProblem& truth, const std::vector<SE3>& poses) {
  double worst_m = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const SE3 off = truth.poses[i].T_camera_world.inverse() * poses[i];
    worst_m = std::max(worst_m, off.translation().norm());
  }
  return worst_m;
}

TEST(InertialFactor, DerivativesAreThoseOfDifferences) {
  using inertial_order::kAll;
  using inertial_order::kGlobal;
  using inertial_order::kGravity;
  using inertial_order::kSpeedFrom;
  using inertial_order::kTo;
  const InertialScene scene = walk_with_imu(2, 0.0, 0);
  const InertialProblem& problem = *scene.truth.inertial;
  InertialUnknowns x = problem.start;
  x.gravity_m_s2 = so3_exp({0.1, -0.2, 0.3}) * kDown;
  x.speed_m_s[1] += Eigen::Vector3d(0.1, 0.2, -0.3);
  SE3 a = scene.truth.poses[0].T_camera_world;
  SE3 b = SE3::exp((Vector6d() << 0.1, 0, 0.05, 0.1, -0.2, 0.1).finished()) *
          scene.truth.poses[1].T_camera_world;
  const auto error = [&](int unknown, double step) {
    InertialUnknowns y = x;
    SE3 from = a, to = b;
    Vector6d twist = Vector6d::Zero();
    if (unknown < kSpeedFrom) twist[unknown % 6] = step;
    if (unknown < kTo) from = SE3::exp(twist) * from;
    if (unknown >= kTo && unknown < kSpeedFrom) to = SE3::exp(twist) * to;
    if (unknown >= kSpeedFrom && unknown < kGlobal) {
      y.speed_m_s[static_cast<std::size_t>((unknown - kSpeedFrom) / 3)][unknown % 3] += step;
    } else if (unknown >= kGlobal && unknown < kGlobal + 3) {
      y.gyro_bias_rad_s[unknown - kGlobal] += step;
    } else if (unknown >= kGlobal + 3 && unknown < kGravity) {
      y.accel_bias_m_s2[unknown - kGlobal - 3] += step;
    } else if (unknown >= kGravity) {
      y.gravity_m_s2 =
          so3_exp(step * axes_across(x.gravity_m_s2).col(unknown - kGravity)) * x.gravity_m_s2;
    }
    return link_error(problem, problem.links[0], from, to, y).residual;
  };
  const LinkError e = link_error(problem, problem.links[0], a, b, x);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < kAll; ++i) {
    const Eigen::Matrix<double, 9, 1> numeric = (error(i, kStep) - error(i, -kStep)) / (2 * kStep);
    EXPECT_LT((numeric - e.jacobian.col(i)).norm(), 1e-6) << "unknown " << i;
  }
}

TEST(InertialFactor, BundleFindsSpeedsBiasesAndGravity) {
  const InertialScene scene = walk_with_imu(14, 0.3);
  const BundleProblem start = unlearnt(synthetic::disturbed(scene.truth, 0.02, 0.01, 0.02, 5));
  BundleOptions options;
  options.robust_iterations = 20;
  const BundleResult result = solve_bundle(scene.camera, start, options);
  ASSERT_TRUE(result.inertial.has_value());
  const InertialUnknowns& x = *result.inertial;
  EXPECT_LT((x.gyro_bias_rad_s - kGyroBias).norm(), 0.002);
  EXPECT_LT((x.accel_bias_m_s2 - kAccelBias).norm(), 0.06);
  EXPECT_LT(std::acos(x.gravity_m_s2.normalized().dot(kDown.normalized())), 0.006);
  EXPECT_NEAR(x.gravity_m_s2.norm(), 9.81, 1e-9);
  for (std::size_t i = 0; i < x.speed_m_s.size(); ++i) {
    const double t_s = static_cast<double>(i) * kEvery_s;
    EXPECT_LT((x.speed_m_s[i] - speed_m_s(t_s)).norm(), 0.02) << i;
  }
  EXPECT_LT(result.final_cost, result.initial_cost);
}

TEST(InertialFactor, HoldsPosesThatHardlySeeAnything) {
  InertialScene scene = walk_with_imu(14, 2.0);
  // Half a second in the middle with six observations for each pose: rough ones.
  std::vector<int> kept(14, 0);
  std::erase_if(scene.truth.observations, [&](const BundleProblem::Observation& o) {
    return (o.pose == 6 || o.pose == 7) && ++kept[static_cast<std::size_t>(o.pose)] > 6;
  });
  BundleProblem with = synthetic::disturbed(scene.truth, 0.05, 0.02, 0.02, 5);
  with.inertial->gravity_sigma_rad = 0.01;
  with.inertial->accel_bias_sigma_m_s2 = 0.05;
  BundleProblem without = with;
  without.inertial.reset();
  const double seen_m = worst_place_m(
      scene.truth, solve_bundle(scene.camera, without, BundleOptions()).T_camera_world);
  const double felt_m =
      worst_place_m(scene.truth, solve_bundle(scene.camera, with, BundleOptions()).T_camera_world);
  EXPECT_LT(felt_m, 0.5 * seen_m) << seen_m << " m without";
}

TEST(InertialFactor, HoldsAPoseThatSeesNothing) {
  InertialScene scene = walk_with_imu(10, 0.3);
  std::erase_if(scene.truth.observations,
                [](const BundleProblem::Observation& o) { return o.pose == 5; });
  BundleProblem start = scene.truth;
  start.poses[5].T_camera_world =
      SE3(Eigen::Quaterniond::Identity(), {0.3, 0, 0}) * start.poses[5].T_camera_world;
  const BundleResult result = solve_bundle(scene.camera, start, BundleOptions());
  EXPECT_LT(worst_place_m(scene.truth, result.T_camera_world), 0.02);
}

TEST(InertialFactor, LinksThatNameNothingAreRefused) {
  InertialScene scene = walk_with_imu(3, 0.3, 20);
  EXPECT_THROW(solve_bundle_ceres(scene.camera, scene.truth, BundleOptions()), std::logic_error);
  scene.truth.inertial->links[0].to = 3;
  EXPECT_THROW(solve_bundle(scene.camera, scene.truth, BundleOptions()), std::logic_error);
  scene.truth.inertial->links.clear();
  EXPECT_FALSE(solve_bundle(scene.camera, scene.truth, BundleOptions()).inertial.has_value());
}

}  // namespace
}  // namespace ydd
