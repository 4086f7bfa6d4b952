// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "ydd/optimization/bundle_adjustment.h"
#include "ydd/optimization/pose_only.h"

/// Synthetic problems with known answers, for the tests and benchmarks of this room.
namespace ydd::synthetic {

inline Vector6d random_twist(std::mt19937& random, double translation_m, double rotation_rad) {
  std::normal_distribution<double> normal;
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = normal(random) * (i < 3 ? translation_m : rotation_rad);
  return twist;
}

/// What a camera sees of a made-up world, and how well.
struct PoseSceneOptions {
  int observations = 200;
  double noise = 1.0;          ///< times the standard deviation that inv_sigma2 tells
  double outlier_share = 0.0;  ///< anywhere in the image
  double mono_share = 0.3;     ///< without a depth reading
  unsigned seed = 1;
};

/// A camera in a made-up world, with the truth.
struct PoseScene {
  Camera camera;
  SE3 T_camera_world;  ///< truth
  std::vector<PoseObservation> observations;
  std::vector<bool> is_outlier;
};

/// Points 0.5 to 5 m in front of a camera at a random pose, pyramid levels 0 to 7.
inline PoseScene make_pose_scene(const PoseSceneOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  PoseScene scene;
  const Camera& c = scene.camera;
  scene.T_camera_world = SE3::exp(random_twist(random, 1.0, 1.0));
  const SE3 T_world_camera = scene.T_camera_world.inverse();
  for (int i = 0; i < options.observations; ++i) {
    const double v_px = unit(random) * c.height_px;
    const Eigen::Vector2d px(unit(random) * c.width_px, v_px);
    const double depth_m = 0.5 + 4.5 * unit(random);
    const double sigma_px = std::pow(1.2, static_cast<int>(8 * unit(random)));
    const double noise_px = options.noise * sigma_px;
    PoseObservation o;
    o.p_world = T_world_camera * c.unproject(px, depth_m);
    o.uvr_px = {px.x(), px.y(), px.x() - c.bf() / depth_m};
    const bool outlier = unit(random) < options.outlier_share;
    if (outlier) {
      const double u = unit(random) * c.width_px;
      o.uvr_px = {u, unit(random) * c.height_px, u - c.bf() / (0.5 + 4.5 * unit(random))};
    }
    for (int row = 0; row < 3; ++row) o.uvr_px[row] += noise_px * normal(random);
    if (unit(random) < options.mono_share || o.uvr_px.z() < 0.0) o.uvr_px.z() = -1.0;
    o.inv_sigma2 = 1.0 / (sigma_px * sigma_px);
    scene.observations.push_back(o);
    scene.is_outlier.push_back(outlier);
  }
  return scene;
}

/// The same of several cameras.
struct BundleSceneOptions {
  int poses = 10;
  int points = 300;
  int fixed_poses = 2;
  double noise = 1.0;          ///< times the standard deviation that inv_sigma2 tells
  double outlier_share = 0.0;  ///< anywhere in the image
  double mono_share = 0.3;     ///< without a depth reading
  int most_views = 1000;       ///< observations of one point
  double path_m = 2.0;         ///< way from the first camera to the last
  unsigned seed = 1;
};

/// Several cameras in a made-up world, with the truth.
struct BundleScene {
  Camera camera;
  BundleProblem truth;  ///< true poses and points, noisy observations
  std::vector<bool> is_outlier;
};

/// Cameras along a path, wavering, that look at a slab of points 1.5 to 5 m ahead of it.
inline BundleScene make_bundle_scene(const BundleSceneOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  BundleScene scene;
  const Camera& c = scene.camera;
  for (int i = 0; i < options.poses; ++i) {
    const double along_m = options.path_m * i / std::max(1, options.poses - 1);
    const SE3 T_path_world(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-along_m, 0, 0));
    const SE3 T = SE3::exp(random_twist(random, 0.1, 0.05)) * T_path_world;
    scene.truth.poses.push_back({T, i < options.fixed_poses});
  }
  while (static_cast<int>(scene.truth.points.size()) < options.points) {
    const double z = 1.5 + 3.5 * unit(random);
    const double y = 3.0 * unit(random) - 1.5;
    const Eigen::Vector3d p((options.path_m + 2.0) * unit(random) - 1.0, y, z);
    const int index = static_cast<int>(scene.truth.points.size());
    int views = 0;
    for (int i = 0; i < options.poses && views < options.most_views; ++i) {
      const Eigen::Vector3d p_camera = scene.truth.poses[i].T_camera_world * p;
      if (p_camera.z() < 0.2) continue;
      const Eigen::Vector2d px = c.project(p_camera);
      if (px.x() < 0 || px.y() < 0 || px.x() >= c.width_px || px.y() >= c.height_px) continue;
      const double sigma_px = std::pow(1.2, static_cast<int>(8 * unit(random)));
      BundleProblem::Observation o{
          i, index, {px.x(), px.y(), px.x() - c.bf() / p_camera.z()}, 1.0 / (sigma_px * sigma_px)};
      const bool outlier = unit(random) < options.outlier_share;
      if (outlier) {
        const double u = unit(random) * c.width_px;
        o.uvr_px = {u, unit(random) * c.height_px, u - c.bf() / (0.5 + 4.5 * unit(random))};
      }
      for (int r = 0; r < 3; ++r) o.uvr_px[r] += options.noise * sigma_px * normal(random);
      if (unit(random) < options.mono_share || o.uvr_px.z() < 0.0) o.uvr_px.z() = -1.0;
      scene.truth.observations.push_back(o);
      scene.is_outlier.push_back(outlier);
      ++views;
    }
    if (views > 0) scene.truth.points.push_back(p);
  }
  return scene;
}

/// The problem with free poses and all points displaced at random.
inline BundleProblem disturbed(BundleProblem problem, double pose_m, double pose_rad,
                               double point_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (auto& pose : problem.poses) {
    if (pose.fixed) continue;
    pose.T_camera_world = SE3::exp(random_twist(random, pose_m, pose_rad)) * pose.T_camera_world;
  }
  for (auto& p : problem.points) {
    for (int i = 0; i < 3; ++i) p[i] += point_m * normal(random);
  }
  return problem;
}

}  // namespace ydd::synthetic
