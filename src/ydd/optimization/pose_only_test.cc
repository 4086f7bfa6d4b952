// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/pose_only.h"

#include <limits>

#include <gtest/gtest.h>

#include "ydd/optimization/reprojection.h"
#include "ydd/optimization/synthetic_scene.h"

namespace ydd {
namespace {

using synthetic::make_pose_scene;
using synthetic::PoseScene;
using synthetic::PoseSceneOptions;

SE3 disturbed(const SE3& T, unsigned seed, double translation_m = 0.05,
              double rotation_rad = 0.05) {
  std::mt19937 random(seed);
  return SE3::exp(synthetic::random_twist(random, translation_m, rotation_rad)) * T;
}

Vector6d error_of(const PoseOnlyResult& result, const PoseScene& scene) {
  return (result.T_camera_world * scene.T_camera_world.inverse()).log();
}

PoseOnlyResult solve(const PoseScene& scene, const SE3& start) {
  return optimize_pose(scene.camera, start, scene.observations, PoseOnlyOptions());
}

class NoiseFree : public testing::TestWithParam<double> {};

TEST_P(NoiseFree, FindsTheTruePose) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    PoseSceneOptions options;
    options.noise = 0.0;
    options.mono_share = GetParam();
    options.seed = seed;
    const PoseScene scene = make_pose_scene(options);
    const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, seed, 0.1, 0.1));
    EXPECT_LT(error_of(result, scene).norm(), 1e-7) << "seed " << seed;
    EXPECT_EQ(result.inliers, options.observations);
  }
}

INSTANTIATE_TEST_SUITE_P(PoseOnly, NoiseFree, testing::Values(0.0, 0.5, 1.0),
                         [](const auto& share) {
                           return "MonoShare" + std::to_string(static_cast<int>(100 * share.param));
                         });

Matrix6d information_of(const PoseOnlyResult& result, const PoseScene& scene) {
  return pose_information(scene.camera, result.T_camera_world, scene.observations, result.inlier);
}

TEST(PoseOnly, FindsTheTruePoseFromFewPoints) {
  PoseSceneOptions options;
  options.noise = 0.0;
  options.mono_share = 0.0;
  for (const int count : {3, 4, 5, 6, 7, 8, 9}) {
    options.observations = count;
    const PoseScene scene = make_pose_scene(options);
    const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, 3, 0.02, 0.02));
    EXPECT_EQ(result.inliers, count);
    EXPECT_LT(error_of(result, scene).norm(), 1e-6) << count << " observations";
  }
}

struct OutlierCase {
  double share;
  double fewest_solved;
};
class Outliers : public testing::TestWithParam<OutlierCase> {};

TEST_P(Outliers, AreFoundAndDoNoHarm) {
  constexpr int kTrials = 50;
  int solved = 0;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    PoseSceneOptions options;
    options.outlier_share = GetParam().share;
    options.seed = seed;
    const PoseScene scene = make_pose_scene(options);
    const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, seed));
    const Vector6d error = error_of(result, scene);
    if (error.dot(information_of(result, scene) * error) > 30.0) continue;  // beyond five sigma
    ++solved;
    int accepted_outliers = 0;
    for (std::size_t i = 0; i < scene.is_outlier.size(); ++i) {
      accepted_outliers += scene.is_outlier[i] && result.inlier[i] ? 1 : 0;
    }
    EXPECT_LE(accepted_outliers, 3);
  }
  EXPECT_GE(solved, GetParam().fewest_solved * kTrials);
}

INSTANTIATE_TEST_SUITE_P(PoseOnly, Outliers,
                         testing::Values(OutlierCase{0.1, 1.0}, OutlierCase{0.3, 1.0},
                                         OutlierCase{0.4, 0.98}),
                         [](const auto& c) {
                           return "Share" + std::to_string(static_cast<int>(100 * c.param.share));
                         });

TEST(PoseOnly, ErrorAgreesWithTheInformation) {
  constexpr int kTrials = 300;
  double sum = 0.0;
  int inliers = 0;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    PoseSceneOptions options;
    options.observations = 100;
    options.seed = seed;
    const PoseScene scene = make_pose_scene(options);
    const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, seed));
    const Vector6d error = error_of(result, scene);
    sum += error.dot(information_of(result, scene) * error);
    inliers += result.inliers;
  }
  // Six degrees of freedom; one sigma of the mean is sqrt(12 / 300) = 0.2.
  EXPECT_NEAR(sum / kTrials, 6.0, 1.0);
  EXPECT_NEAR(inliers / (100.0 * kTrials), 0.95, 0.01);
}

TEST(PoseOnly, InformationIsTheHessianOfTheInliers) {
  const PoseScene scene = make_pose_scene({.observations = 37, .outlier_share = 0.2});
  const PoseOnlyResult result = solve(scene, scene.T_camera_world);
  const Intrinsics k(scene.camera);
  Matrix6d expected = Matrix6d::Zero();
  for (std::size_t i = 0; i < scene.observations.size(); ++i) {
    if (!result.inlier[i]) continue;
    const PoseObservation& o = scene.observations[i];
    const Eigen::Vector3d p = result.T_camera_world * o.p_world;
    auto jacobian = twist_jacobian(Reprojection<double>(k, p.x(), p.y(), p.z()));
    if (o.uvr_px.z() < 0.0) jacobian.row(2).setZero();
    expected += o.inv_sigma2 * jacobian.transpose() * jacobian;
  }
  EXPECT_LT((expected - information_of(result, scene)).norm(), 1e-9 * expected.norm());
}

TEST(PoseOnly, SolutionIsAMinimumOverTheInliers) {
  const PoseScene scene = make_pose_scene({.observations = 150, .outlier_share = 0.2});
  const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, 2));
  const Intrinsics k(scene.camera);
  const auto cost_at = [&](const SE3& T) {
    double cost = 0.0;
    for (std::size_t i = 0; i < scene.observations.size(); ++i) {
      const PoseObservation& o = scene.observations[i];
      if (!result.inlier[i]) continue;
      const Eigen::Vector3d p = T * o.p_world;
      const Reprojection<double> seen(k, p.x(), p.y(), p.z());
      Eigen::Vector3d e = Eigen::Vector3d(seen.u, seen.v, seen.r) - o.uvr_px;
      if (o.uvr_px.z() < 0.0) e.z() = 0.0;
      cost += 0.5 * o.inv_sigma2 * e.squaredNorm();
    }
    return cost;
  };
  const double cost = cost_at(result.T_camera_world);
  for (int axis = 0; axis < 6; ++axis) {
    for (const double step : {-1e-3, 1e-3}) {
      Vector6d twist = Vector6d::Zero();
      twist[axis] = step;
      EXPECT_GT(cost_at(SE3::exp(twist) * result.T_camera_world), cost) << "axis " << axis;
    }
  }
}

TEST(PoseOnly, FewerThanThreeObservationsLeaveThePose) {
  for (const int count : {0, 1, 2}) {
    const PoseScene scene = make_pose_scene({.observations = count, .noise = 0.0});
    const SE3 start = disturbed(scene.T_camera_world, 1);
    const PoseOnlyResult result = solve(scene, start);
    EXPECT_EQ(result.inliers, 0);
    EXPECT_EQ(result.inlier, std::vector<std::uint8_t>(count, 0));
    EXPECT_EQ(result.T_camera_world.matrix(), start.matrix());
  }
}

TEST(PoseOnly, PointsBehindTheCameraAreOutliers) {
  PoseScene scene = make_pose_scene({.observations = 60, .noise = 0.0});
  for (std::size_t i = 0; i < 10; ++i) {
    // The mirrored point projects to the same pixel.
    const Eigen::Vector3d p_camera = scene.T_camera_world * scene.observations[i].p_world;
    scene.observations[i].p_world = scene.T_camera_world.inverse() * Eigen::Vector3d(-p_camera);
    scene.observations[i].uvr_px.z() = -1.0;
  }
  const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, 5));
  EXPECT_EQ(result.inliers, 50);
  EXPECT_LT(error_of(result, scene).norm(), 1e-7);

  // A camera that looks the other way sees nothing at all.
  const SE3 T_turned_camera(Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero());
  const PoseScene ahead = make_pose_scene({.observations = 60});
  const SE3 start = T_turned_camera * ahead.T_camera_world;
  const PoseOnlyResult nothing = solve(ahead, start);
  EXPECT_EQ(nothing.inliers, 0);
  EXPECT_EQ(nothing.T_camera_world.matrix(), start.matrix());
}

TEST(PoseOnly, NothingButOutliersGivesFewInliers) {
  const PoseScene scene = make_pose_scene({.observations = 200, .outlier_share = 1.0});
  const PoseOnlyResult result = solve(scene, scene.T_camera_world);
  EXPECT_LT(result.inliers, 20);
  EXPECT_TRUE(result.T_camera_world.matrix().allFinite());
}

TEST(PoseOnly, UnusableObservationsAreOutliers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  PoseScene scene = make_pose_scene({.observations = 50, .noise = 0.0});
  scene.observations[3].p_world.x() = kNan;
  scene.observations[7].uvr_px.y() = std::numeric_limits<double>::infinity();
  scene.observations[11].inv_sigma2 = 0.0;
  scene.observations[12].inv_sigma2 = -1.0;
  const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, 9));
  EXPECT_EQ(result.inliers, 46);
  for (const std::size_t i : {3, 7, 11, 12}) EXPECT_EQ(result.inlier[i], 0) << i;
  EXPECT_LT(error_of(result, scene).norm(), 1e-7);
}

TEST(PoseOnly, MissingDepthReadingIsNotUsed) {
  // Same pixels, wrong right-image coordinates marked as missing: they must not matter.
  PoseScene scene = make_pose_scene({.observations = 80, .noise = 0.0, .mono_share = 1.0});
  for (PoseObservation& o : scene.observations) o.uvr_px.z() = -500.0;
  const PoseOnlyResult result = solve(scene, disturbed(scene.T_camera_world, 4));
  EXPECT_EQ(result.inliers, 80);
  EXPECT_LT(error_of(result, scene).norm(), 1e-7);
}

TEST(PoseOnly, TwoCallsGiveTheSameBits) {
  const PoseScene scene = make_pose_scene({.observations = 123, .outlier_share = 0.3});
  const SE3 start = disturbed(scene.T_camera_world, 8);
  const PoseOnlyResult a = solve(scene, start);
  const PoseOnlyResult b = solve(scene, start);
  EXPECT_EQ(a.T_camera_world.matrix(), b.T_camera_world.matrix());
  EXPECT_EQ(a.inlier, b.inlier);
}

}  // namespace
}  // namespace ydd
