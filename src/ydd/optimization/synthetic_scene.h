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

struct PoseSceneOptions {
  int observations = 200;
  double noise = 1.0;          ///< times the standard deviation that inv_sigma2 tells
  double outlier_share = 0.0;  ///< anywhere in the image
  double mono_share = 0.3;     ///< without a depth reading
  unsigned seed = 1;
};

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
    const Eigen::Vector2d px(unit(random) * c.width_px, unit(random) * c.height_px);
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

}  // namespace ydd::synthetic
