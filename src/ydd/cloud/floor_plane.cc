// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/floor_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace ydd {
namespace {

constexpr int kDraws = 1500;
constexpr float kOnPlane_m = 0.03F;
constexpr float kBelow_m = 0.10F;     // lower than noise explains
constexpr double kMostBelow = 0.02;   // of all points: mirrored and stray ones
constexpr double kLeastShare = 0.02;  // of all points that lie on a floor
constexpr double kMostTilt_rad = 35.0 * std::numbers::pi / 180.0;
constexpr std::size_t kMostPoints = 20000;

struct Candidate {
  Eigen::Vector3f up;
  float height_m = 0;
  std::size_t on = 0, below = 0;
};

std::vector<Eigen::Vector3f> thinned(std::span<const Eigen::Vector3f> points) {
  std::vector<Eigen::Vector3f> out;
  const std::size_t step = points.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < points.size(); i += step) out.push_back(points[i]);
  return out;
}

void count_points(const std::vector<Eigen::Vector3f>& points, Candidate& plane) {
  plane.on = plane.below = 0;
  for (const Eigen::Vector3f& p : points) {
    const float above_m = plane.up.dot(p) - plane.height_m;
    if (std::abs(above_m) <= kOnPlane_m) ++plane.on;
    if (above_m < -kBelow_m) ++plane.below;
  }
}

bool is_level(const Eigen::Vector3f& up, const Eigen::Vector3f& expected) {
  return up.dot(expected) >= static_cast<float>(std::cos(kMostTilt_rad));
}

/// Least squares over the points that are on it.
Candidate refined(const std::vector<Eigen::Vector3f>& points, const Candidate& plane,
                  const Eigen::Vector3f& expected_up) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double count = 0;
  for (const Eigen::Vector3f& p : points) {
    if (std::abs(plane.up.dot(p) - plane.height_m) > kOnPlane_m) continue;
    const Eigen::Vector3d q = p.cast<double>();
    mean += q;
    spread += q * q.transpose();
    ++count;
  }
  mean /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread / count -
                                                            mean * mean.transpose());
  Eigen::Vector3f up = axes.eigenvectors().col(0).cast<float>();
  if (up.dot(expected_up) < 0) up = -up;
  Candidate out{up, up.dot(mean.cast<float>())};
  count_points(points, out);
  // Three points can be luckier than they are right.
  const bool as_good = 10 * out.on >= 9 * plane.on;
  return is_level(up, expected_up) && as_good ? out : plane;
}

std::optional<Candidate> best_plane(const std::vector<Eigen::Vector3f>& points,
                                    const Eigen::Vector3f& expected_up, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::optional<Candidate> best;
  const auto draw = [&] { return points[random() % points.size()]; };
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3f a = draw(), b = draw(), c = draw();
    Eigen::Vector3f up = (b - a).cross(c - a);
    if (up.norm() < 1e-3F) continue;
    up.normalize();
    if (up.dot(expected_up) < 0) up = -up;
    if (!is_level(up, expected_up)) continue;
    Candidate plane{up, up.dot(a)};
    count_points(points, plane);
    const auto all = static_cast<double>(points.size());
    if (static_cast<double>(plane.below) > kMostBelow * all) continue;
    if (!best || plane.on > best->on) best = plane;
  }
  if (!best) return std::nullopt;
  for (int i = 0; i < 3; ++i) best = refined(points, *best, expected_up);
  return best;
}

/// Nothing below it but what is stray.
double lowest_height_m(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& up) {
  if (points.empty()) return 0;
  std::vector<float> heights_m;
  for (const Eigen::Vector3f& p : points) heights_m.push_back(up.dot(p));
  const auto k = static_cast<std::ptrdiff_t>(0.01 * static_cast<double>(heights_m.size()));
  std::nth_element(heights_m.begin(), heights_m.begin() + k, heights_m.end());
  return static_cast<double>(heights_m[static_cast<std::size_t>(k)]);
}

}  // namespace

FloorPlane find_floor(std::span<const Eigen::Vector3f> points_world,
                      const Eigen::Vector3d& expected_up, std::uint32_t seed) {
  const std::vector<Eigen::Vector3f> points = thinned(points_world);
  const Eigen::Vector3f expected = expected_up.cast<float>();
  FloorPlane floor;
  floor.up = expected_up;
  floor.height_m = lowest_height_m(points, expected);
  if (points.size() < 100) return floor;
  const std::optional<Candidate> plane = best_plane(points, expected, seed);
  if (!plane) return floor;
  floor.share = static_cast<double>(plane->on) / static_cast<double>(points.size());
  if (floor.share < kLeastShare) return floor;
  floor.found = true;
  floor.up = plane->up.cast<double>().normalized();
  floor.height_m = static_cast<double>(plane->height_m);
  return floor;
}

SE3 level_frame(const FloorPlane& floor) {
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() - floor.up.z() * floor.up;
  if (ahead.norm() < 1e-3) ahead = Eigen::Vector3d::UnitX() - floor.up.x() * floor.up;
  ahead.normalize();
  Eigen::Matrix3d R;  // rows: the axes of the level frame in the world
  R.row(0) = ahead;
  R.row(1) = floor.up.cross(ahead);
  R.row(2) = floor.up;
  return {R, Eigen::Vector3d(0, 0, -floor.height_m)};
}

}  // namespace ydd
