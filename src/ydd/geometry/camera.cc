// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/LU>

namespace ydd {
namespace {

struct Distorted {
  Eigen::Vector2d xy;        ///< normalised, distorted
  Eigen::Matrix2d jacobian;  ///< of xy by the undistorted normalised coordinates
};

Distorted distort_normalised(const Camera& c, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double slope = c.k1 + r2 * (2.0 * c.k2 + 3.0 * c.k3 * r2);  // d radial / d r2
  Distorted d;
  d.xy = {x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x),
          y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y};
  d.jacobian << radial + 2.0 * x * x * slope + 2.0 * c.p1 * y + 6.0 * c.p2 * x,
      2.0 * x * y * slope + 2.0 * c.p1 * x + 2.0 * c.p2 * y,
      2.0 * x * y * slope + 2.0 * c.p1 * x + 2.0 * c.p2 * y,
      radial + 2.0 * y * y * slope + 6.0 * c.p1 * y + 2.0 * c.p2 * x;
  return d;
}

}  // namespace

void Camera::describe(OptionTable& t) {
  const Range focal{1.0, 1e5};
  const Range centre{-1e5, 1e5};
  const Range coefficient{-100.0, 100.0};
  t.add("name", name, {}, "a name for reports");
  t.add("width", width_px, {16, 16384}, "px", "image width");
  t.add("height", height_px, {16, 16384}, "px", "image height");
  t.add("fx", fx_px, focal, "px", "focal length, horizontal");
  t.add("fy", fy_px, focal, "px", "focal length, vertical");
  t.add("cx", cx_px, centre, "px", "principal point, horizontal");
  t.add("cy", cy_px, centre, "px", "principal point, vertical");
  t.add("k1", k1, coefficient, "", "radial distortion, second order");
  t.add("k2", k2, coefficient, "", "radial distortion, fourth order");
  t.add("p1", p1, coefficient, "", "tangential distortion");
  t.add("p2", p2, coefficient, "", "tangential distortion");
  t.add("k3", k3, coefficient, "", "radial distortion, sixth order");
  t.add("depth_scale", depth_scale, {1.0, 1e6}, "1/m", "depth image value of one metre");
  t.add("min_depth", min_depth_m, {0.0, 100.0}, "m", "nearer depth readings are invalid");
  t.add("max_depth", max_depth_m, {0.1, 1000.0}, "m", "farther depth readings are invalid");
  t.add("fps", fps, {0.1, 1000.0}, "Hz", "frame rate");
  t.add("baseline", baseline_m, {1e-3, 10.0}, "m", "baseline of the virtual stereo pair");
}

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& undistorted_px) const {
  if (!has_distortion()) return undistorted_px;
  const Distorted d = distort_normalised(*this, (undistorted_px.x() - cx_px) / fx_px,
                                         (undistorted_px.y() - cy_px) / fy_px);
  return {fx_px * d.xy.x() + cx_px, fy_px * d.xy.y() + cy_px};
}

Eigen::Vector2d Camera::undistort(const Eigen::Vector2d& image_px) const {
  if (!has_distortion()) return image_px;
  const Eigen::Vector2d target((image_px.x() - cx_px) / fx_px, (image_px.y() - cy_px) / fy_px);
  Eigen::Vector2d xy = target;
  for (int i = 0; i < 20; ++i) {
    const Distorted d = distort_normalised(*this, xy.x(), xy.y());
    const Eigen::Vector2d residual = d.xy - target;
    if (residual.squaredNorm() < 1e-20) break;
    xy -= d.jacobian.inverse() * residual;
  }
  return {fx_px * xy.x() + cx_px, fy_px * xy.y() + cy_px};
}

Result<void> check_camera(const Camera& camera) {
  Camera c = camera;
  if (c.cx_px < 0 || c.cy_px < 0 || c.cx_px >= c.width_px || c.cy_px >= c.height_px) {
    return Error{
        fmt::format("the principal point ({}, {}) lies outside of the picture of {} x {}; "
                    "are cx, cy and the picture's size right?",
                    c.cx_px, c.cy_px, c.width_px, c.height_px)};
  }
  if (std::max(c.fx_px, c.fy_px) > 2 * std::min(c.fx_px, c.fy_px)) {
    return Error{
        fmt::format("the focal lengths {} and {} differ by more than a factor of two; are "
                    "fx and fy right?",
                    c.fx_px, c.fy_px)};
  }
  constexpr double kNarrowest_deg = 3;
  constexpr double kWidest_deg = 150;
  const double opening_deg =
      2 * std::atan(0.5 * std::max(c.width_px, c.height_px) / c.fx_px) * 180 / std::numbers::pi;
  if (opening_deg < kNarrowest_deg || opening_deg > kWidest_deg) {
    return Error{
        fmt::format("a focal length of {} px in a picture of {} x {} is an opening of "
                    "{:.1f} degrees; are fx and the picture's size right?",
                    c.fx_px, c.width_px, c.height_px, opening_deg)};
  }
  if (c.min_depth_m >= c.max_depth_m) {
    return Error{fmt::format("min_depth {} m must be less than max_depth {} m", c.min_depth_m,
                             c.max_depth_m)};
  }
  OptionTable table;
  c.describe(table);
  for (const Option& option : table.options()) {
    if (option.key == "name") continue;
    if (auto r = table.set(option.key, format_value(option), "camera"); !r) return r;
  }
  return {};
}

}  // namespace ydd
