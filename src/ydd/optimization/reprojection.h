// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// What the solvers need of a camera: focal lengths and principal point in px, fx * baseline in px
/// m.
struct Intrinsics {
  double fx, fy, cx, cy, bf;
  explicit Intrinsics(const Camera& c)
      : fx(c.fx_px), fy(c.fy_px), cx(c.cx_px), cy(c.cy_px), bf(c.bf()) {}
};

/// Projection of a point of the camera frame into (u, v, r), r being the virtual right-image u, and
/// the non-zero derivatives of the three rows by a left perturbation exp(twist) * T_camera_world,
/// twist = (translation, rotation). The first three columns are the derivatives by the point
/// itself.
///
///     du = [ du0   0   du2 du3 du4 du5 ]
///     dv = [  0   dv1  dv2 dv3 dv4 dv5 ]
///     dr = [ du0   0   dr2 dr3 dr4 du5 ]
///
/// `Number` is double, or a pack of doubles for several points at once. z must be > 0.
template <class Number>
struct Reprojection {
  Number u, v, r;
  Number du0, du2, du3, du4, du5;
  Number dv1, dv2, dv3, dv4, dv5;
  Number dr2, dr3, dr4;

  Reprojection(const Intrinsics& k, const Number& x, const Number& y, const Number& z) {
    const Number inv_z = 1.0 / z;
    const Number xn = x * inv_z;
    const Number yn = y * inv_z;
    const Number disparity = k.bf * inv_z;
    u = k.fx * xn + k.cx;
    v = k.fy * yn + k.cy;
    r = u - disparity;
    du0 = k.fx * inv_z;
    du2 = -du0 * xn;
    du3 = -k.fx * xn * yn;
    du4 = k.fx + k.fx * xn * xn;
    du5 = -k.fx * yn;
    dv1 = k.fy * inv_z;
    dv2 = -dv1 * yn;
    dv3 = -k.fy - k.fy * yn * yn;
    dv4 = k.fy * xn * yn;
    dv5 = k.fy * xn;
    dr2 = du2 + disparity * inv_z;
    dr3 = du3 + disparity * yn;
    dr4 = du4 - disparity * xn;
  }
};

/// The derivatives of a Reprojection as a matrix, rows u, v, r.
inline Eigen::Matrix<double, 3, 6> twist_jacobian(const Reprojection<double>& p) {
  Eigen::Matrix<double, 3, 6> j;
  j << p.du0, 0.0, p.du2, p.du3, p.du4, p.du5,  //
      0.0, p.dv1, p.dv2, p.dv3, p.dv4, p.dv5,   //
      p.du0, 0.0, p.dr2, p.dr3, p.dr4, p.du5;
  return j;
}

/// Points nearer than this to the image plane, or behind it, count as not visible.
inline constexpr double kNearestDepthM = 1e-3;

/// What a trial step pays, as chi-square, for an observation whose point it puts behind the camera:
/// enough to be noticed, too little to hold up everything else. Such observations have no
/// derivatives, for those of a mirrored point lead astray.
inline constexpr double kChi2Behind = 100.0;

}  // namespace ydd
