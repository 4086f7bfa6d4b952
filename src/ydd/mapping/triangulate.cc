// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/triangulate.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ydd/geometry/triangulation.h"

namespace ydd {
namespace {

struct View {
  const KeyFrame* keyframe;
  SE3 T_camera_world;
  std::vector<int> free;  ///< keypoints without a point
};

View make_view(const Atlas& atlas, KeyFrameId id) {
  const KeyFrame& keyframe = atlas.at(id);
  View view{&keyframe, keyframe.T_world_camera.inverse(), {}};
  for (int i = 0; i < static_cast<int>(keyframe.points.size()); ++i) {
    if (!keyframe.points[static_cast<std::size_t>(i)].valid()) view.free.push_back(i);
  }
  return view;
}

Eigen::Matrix3d intrinsic_matrix(const Camera& c) {
  Eigen::Matrix3d K;
  K << c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1;
  return K;
}

/// F with x2^T F x1 = 0 in undistorted pixels. Hartley and Zisserman, eq. (9.2).
Eigen::Matrix3d fundamental(const Camera& camera, const View& v1, const View& v2) {
  const SE3 T_2_1 = v2.T_camera_world * v1.T_camera_world.inverse();
  const Eigen::Matrix3d K_inverse = intrinsic_matrix(camera).inverse();
  return K_inverse.transpose() * skew(T_2_1.translation()) * T_2_1.rotation_matrix() * K_inverse;
}

/// Best free keypoint of view 2 along the epipolar line of keypoint i of view 1, or -1.
int match_on_line(const Atlas& atlas, const View& v1, int i, const View& v2,
                  const Eigen::Matrix3d& F, const TriangulationOptions& options,
                  const MatchLimits& limits) {
  const Features& f1 = v1.keyframe->features();
  const Features& f2 = v2.keyframe->features();
  const Eigen::Vector2f& px1 = f1.undistorted_px[static_cast<std::size_t>(i)];
  const Eigen::Vector3d line = F * Eigen::Vector3d(px1.x(), px1.y(), 1.0);
  const double norm2 = line.head<2>().squaredNorm();
  if (norm2 <= 0) return -1;
  int best = -1;
  int best_distance = limits.strict;
  for (const int k : v2.free) {
    const auto j = static_cast<std::size_t>(k);
    const Eigen::Vector2f& px2 = f2.undistorted_px[j];
    const double d = line.x() * px2.x() + line.y() * px2.y() + line.z();
    const double inv_sigma2 =
        atlas.scales().inv_sigma2[static_cast<std::size_t>(f2.keypoints[j].octave)];
    if (d * d * inv_sigma2 > options.epipolar_chi2 * norm2) continue;
    const int distance =
        hamming_distance(f1.descriptors[static_cast<std::size_t>(i)], f2.descriptors[j]);
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = k;
  }
  return best;
}

Eigen::Vector3d ray_of(const Camera& camera, const View& view, int i) {
  return camera.unproject(
      view.keyframe->features().undistorted_px[static_cast<std::size_t>(i)].cast<double>(), 1.0);
}

bool reprojects(const Atlas& atlas, const View& view, int i, const Eigen::Vector3d& p_world) {
  const Camera& camera = atlas.camera();
  const Eigen::Vector3d p_camera = view.T_camera_world * p_world;
  if (p_camera.z() <= 0) return false;
  const Features& f = view.keyframe->features();
  const Eigen::Vector3d seen = uvr_px(f, i);
  const Eigen::Vector2d px = camera.project(p_camera);
  const double right_error_px = seen.z() < 0 ? 0.0 : px.x() - camera.bf() / p_camera.z() - seen.z();
  const double error2 = (px - seen.head<2>()).squaredNorm() + right_error_px * right_error_px;
  const auto octave = static_cast<std::size_t>(f.keypoints[static_cast<std::size_t>(i)].octave);
  return error2 * atlas.scales().inv_sigma2[octave] <= (seen.z() < 0 ? 5.991 : 7.815);
}

/// By depth where there is a reading, else by triangulation if the rays meet at an angle.
std::optional<Eigen::Vector3d> place(const Atlas& atlas, const View& v1, int i, const View& v2,
                                     int k, const TriangulationOptions& options) {
  const Camera& camera = atlas.camera();
  const Eigen::Vector3d ray1 = ray_of(camera, v1, i);
  const Eigen::Vector3d ray2 = ray_of(camera, v2, k);
  const float depth1_m = v1.keyframe->features().depth_m[static_cast<std::size_t>(i)];
  const float depth2_m = v2.keyframe->features().depth_m[static_cast<std::size_t>(k)];
  if (depth1_m > 0) return v1.keyframe->T_world_camera * Eigen::Vector3d(ray1 * depth1_m);
  if (depth2_m > 0) return v2.keyframe->T_world_camera * Eigen::Vector3d(ray2 * depth2_m);
  const Eigen::Vector3d d1 = v1.keyframe->T_world_camera.rotation() * ray1.normalized();
  const Eigen::Vector3d d2 = v2.keyframe->T_world_camera.rotation() * ray2.normalized();
  const double cosine = d1.dot(d2);
  if (cosine <= 0 || cosine > options.min_parallax_cosine) return std::nullopt;
  return triangulate(v1.T_camera_world, ray1, v2.T_camera_world, ray2);
}

struct NewPoint {
  int i = 0, k = 0;
  Eigen::Vector3d p_world;
};

std::vector<NewPoint> find_new_points(const Atlas& atlas, const View& v1, const View& v2,
                                      const TriangulationOptions& options,
                                      const MatchLimits& limits) {
  std::vector<NewPoint> out;
  const Eigen::Matrix3d F = fundamental(atlas.camera(), v1, v2);
  std::vector<std::uint8_t> taken(v2.keyframe->points.size(), 0);
  for (const int i : v1.free) {
    const int k = match_on_line(atlas, v1, i, v2, F, options, limits);
    if (k < 0 || taken[static_cast<std::size_t>(k)] != 0) continue;
    const auto p_world = place(atlas, v1, i, v2, k, options);
    if (!p_world || !reprojects(atlas, v1, i, *p_world) || !reprojects(atlas, v2, k, *p_world)) {
      continue;
    }
    taken[static_cast<std::size_t>(k)] = 1;
    out.push_back({i, k, *p_world});
  }
  return out;
}

}  // namespace

void TriangulationOptions::describe(OptionTable& t) {
  t.add("neighbours", neighbours, {0, 100}, "", "keyframes to match with");
  t.add("min_baseline_m", min_baseline_m, {0.0, 10.0}, "m", "distance between the two views");
  t.add("min_parallax_cosine", min_parallax_cosine, {0.9, 1.0}, "",
        "rays must differ at least by this cosine");
  t.add("epipolar_chi2", epipolar_chi2, {0.1, 100.0}, "", "squared distance from the line");
}

std::vector<MapPointId> triangulate_with_neighbours(Atlas& atlas, KeyFrameId id,
                                                    const TriangulationOptions& options,
                                                    const MatchLimits& limits) {
  std::vector<MapPointId> created;
  const std::vector<Covisible> neighbours = atlas.at(id).covisible;
  const auto n = std::min(neighbours.size(), static_cast<std::size_t>(options.neighbours));
  for (std::size_t c = 0; c < n; ++c) {
    const KeyFrameId other = neighbours[c].keyframe;
    const View v1 = make_view(atlas, id);
    const View v2 = make_view(atlas, other);
    const double baseline_m =
        (v1.keyframe->T_world_camera.translation() - v2.keyframe->T_world_camera.translation())
            .norm();
    if (baseline_m < options.min_baseline_m) continue;
    for (const NewPoint& p : find_new_points(atlas, v1, v2, options, limits)) {
      const MapPointId point = atlas.add_point(p.p_world, id, p.i);
      atlas.add_observation(point, other, p.k);
      atlas.refresh_point(point);
      created.push_back(point);
    }
  }
  return created;
}

}  // namespace ydd
