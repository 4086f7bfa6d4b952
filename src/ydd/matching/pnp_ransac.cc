// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/pnp_ransac.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <opencv2/calib3d.hpp>

namespace ydd {
namespace {

constexpr std::size_t kSample = 3;
constexpr double kConfidence = 0.99;

/// The matches as the solver wants them.
struct Problem {
  std::vector<Eigen::Vector3d> p_world;
  std::vector<Eigen::Vector2d> px;
  cv::Matx33d intrinsics;
};

Problem problem_of(const Camera& camera, const Features& features,
                   const std::vector<PointMatch>& matches) {
  Problem out;
  for (const PointMatch& m : matches) {
    out.p_world.push_back(m.p_world);
    out.px.push_back(features.undistorted_px[static_cast<std::size_t>(m.keypoint)].cast<double>());
  }
  out.intrinsics =
      cv::Matx33d(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  return out;
}

/// `mt19937` is the same everywhere; the distributions of the standard library are not.
std::array<std::size_t, kSample> draw(std::mt19937& random, std::size_t count) {
  std::array<std::size_t, kSample> sample{};
  for (std::size_t i = 0; i < kSample; ++i) {
    do {
      sample[i] = random() % count;
    } while (std::find(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(i),
                       sample[i]) != sample.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return sample;
}

std::vector<SE3> poses_of(const Problem& problem, const std::array<std::size_t, kSample>& sample) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const std::size_t i : sample) {
    points.emplace_back(problem.p_world[i].x(), problem.p_world[i].y(), problem.p_world[i].z());
    pixels.emplace_back(problem.px[i].x(), problem.px[i].y());
  }
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::solveP3P(points, pixels, problem.intrinsics, cv::noArray(), rotations, translations,
               cv::SOLVEPNP_AP3P);
  std::vector<SE3> poses;
  for (std::size_t k = 0; k < rotations.size(); ++k) {
    const Eigen::Vector3d turn(rotations[k].at<double>(0), rotations[k].at<double>(1),
                               rotations[k].at<double>(2));
    const Eigen::Vector3d shift(translations[k].at<double>(0), translations[k].at<double>(1),
                                translations[k].at<double>(2));
    if (turn.allFinite() && shift.allFinite()) poses.emplace_back(so3_exp(turn), shift);
  }
  return poses;
}

std::size_t agreeing(const Camera& camera, const Problem& problem, const SE3& T_camera_world,
                     double threshold_px) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < problem.px.size(); ++i) {
    const Eigen::Vector3d p = T_camera_world * problem.p_world[i];
    if (p.z() <= 0) continue;
    const Eigen::Vector2d px(camera.fx_px * p.x() / p.z() + camera.cx_px,
                             camera.fy_px * p.y() / p.z() + camera.cy_px);
    if ((px - problem.px[i]).squaredNorm() <= threshold_px * threshold_px) ++count;
  }
  return count;
}

/// Samples after which one of inliers alone has been drawn with the wanted confidence.
double samples_needed(double inlier_share) {
  const double clean = std::pow(inlier_share, static_cast<double>(kSample));
  if (clean >= 1.0) return 1;
  return std::log(1.0 - kConfidence) / std::log(1.0 - std::max(clean, 1e-9));
}

}  // namespace

std::optional<SE3> pnp_ransac(const Camera& camera, const Features& features,
                              const std::vector<PointMatch>& matches,
                              const PnpRansacOptions& options) {
  if (matches.size() < 4) return std::nullopt;
  const Problem problem = problem_of(camera, features, matches);
  std::mt19937 random(options.seed);
  std::optional<SE3> best;
  std::size_t most = 3;  // a consensus of four is the least
  double needed = options.iterations;
  for (int i = 0; i < options.iterations && i < needed; ++i) {
    for (const SE3& pose : poses_of(problem, draw(random, matches.size()))) {
      const std::size_t count = agreeing(camera, problem, pose, options.threshold_px);
      if (count <= most) continue;
      most = count;
      best = pose;
      needed = samples_needed(static_cast<double>(count) / static_cast<double>(matches.size()));
    }
  }
  return best;
}

}  // namespace ydd
