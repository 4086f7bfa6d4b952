// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_linearise.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "ydd/optimization/bundle_inertial.h"
#include "ydd/optimization/reprojection.h"

namespace ydd::bundle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Pose {
  Matrix3d rotation;
  Vector3d translation;
};

std::vector<Pose> matrices_of(const std::vector<SE3>& poses) {
  std::vector<Pose> out;
  out.reserve(poses.size());
  for (const SE3& T : poses) out.push_back({T.rotation_matrix(), T.translation()});
  return out;
}

double gate_of(const Layout::Entry& e, const Loss& loss) {
  return e.stereo ? loss.chi2_stereo : loss.chi2_mono;
}

/// Predicted minus observed, in px; nothing in the third row without a depth reading.
Vector3d residual_px(const Intrinsics& k, const Layout::Entry& e, const Vector3d& p) {
  const double inv_z = 1.0 / p.z();
  const double u = k.fx * p.x() * inv_z + k.cx;
  const double v = k.fy * p.y() * inv_z + k.cy;
  return {u - e.uvr_px.x(), v - e.uvr_px.y(), e.stereo ? u - k.bf * inv_z - e.uvr_px.z() : 0.0};
}

double chi2_of(const Intrinsics& k, const Layout::Entry& e, const Vector3d& p) {
  if (p.z() <= kNearestDepthM) return kChi2Behind;
  return e.inv_sigma2 * residual_px(k, e, p).squaredNorm();
}

double rho_of(double chi2, double gate, bool huber) {
  return huber && chi2 > gate ? 2.0 * std::sqrt(gate * chi2) - gate : chi2;
}

/// Gradient and Gauss-Newton Hessian of one observation by the point in the camera frame.
struct PointTerms {
  double rho = 0.0;
  Vector3d gradient = Vector3d::Zero();
  Matrix3d hessian = Matrix3d::Zero();
};

PointTerms terms_of(const Intrinsics& k, const Layout::Entry& e, const Vector3d& p,
                    const Loss& loss) {
  const double gate = gate_of(e, loss);
  if (p.z() <= kNearestDepthM) return {rho_of(kChi2Behind, gate, loss.huber)};
  PointTerms t;
  const Vector3d r = residual_px(k, e, p);
  const double chi2 = e.inv_sigma2 * r.squaredNorm();
  t.rho = rho_of(chi2, gate, loss.huber);
  const double w = e.inv_sigma2 * (loss.huber && chi2 > gate ? std::sqrt(gate / chi2) : 1.0);
  // Rows of the projection's derivative: u (a, 0, ua), v (0, b, vb), r (a, 0, ra).
  const double inv_z = 1.0 / p.z();
  const double a = k.fx * inv_z;
  const double b = k.fy * inv_z;
  const double ua = -a * p.x() * inv_z;
  const double vb = -b * p.y() * inv_z;
  const double ra = ua + k.bf * inv_z * inv_z;
  const double wr = e.stereo ? w : 0.0;
  t.gradient << a * (w * r.x() + wr * r.z()), w * b * r.y(),
      w * (ua * r.x() + vb * r.y()) + wr * ra * r.z();
  const double xx = a * a * (w + wr);
  const double xz = a * (w * ua + wr * ra);
  const double yz = w * b * vb;
  t.hessian << xx, 0.0, xz, 0.0, w * b * b, yz, xz, yz, w * (ua * ua + vb * vb) + wr * ra * ra;
  return t;
}

/// `skew(p) * m` without the multiplications by zero.
Matrix3d cross_columns(const Vector3d& p, const Matrix3d& m) {
  Matrix3d out;
  out.row(0) = p.y() * m.row(2) - p.z() * m.row(1);
  out.row(1) = p.z() * m.row(0) - p.x() * m.row(2);
  out.row(2) = p.x() * m.row(1) - p.y() * m.row(0);
  return out;
}

/// A moved point is G * twist away, G = (I, -skew(p)): everything about the pose is G' of what is
/// known about the point.
void add_pose_terms(const Vector3d& p, const PointTerms& t, Matrix6d& hessian, Vector6d& gradient) {
  const Matrix3d turned = cross_columns(p, t.hessian);  // skew(p) A; its transpose is A (-skew(p))
  hessian.topLeftCorner<3, 3>() += t.hessian;
  hessian.bottomLeftCorner<3, 3>() += turned;
  hessian.topRightCorner<3, 3>() += turned.transpose();
  hessian.bottomRightCorner<3, 3>() += cross_columns(p, turned.transpose());
  gradient.head<3>() += t.gradient;
  gradient.tail<3>() += p.cross(t.gradient);
}

NormalEquations cleared(NormalEquations n, const Layout& layout) {
  n.cost = 0.0;
  n.pose_hessian.assign(layout.columns(), Matrix6d::Zero());
  n.pose_gradient.assign(layout.columns(), Vector6d::Zero());
  n.point_hessian.assign(layout.points(), Matrix3d::Zero());
  n.point_gradient.assign(layout.points(), Vector3d::Zero());
  n.coupling.resize(layout.entries.size());
  return n;
}

void check_indices(const BundleProblem& problem) {
  const int poses = static_cast<int>(problem.poses.size());
  const int points = static_cast<int>(problem.points.size());
  for (const auto& o : problem.observations) {
    if (o.pose < 0 || o.pose >= poses || o.point < 0 || o.point >= points) {
      throw std::logic_error(fmt::format(
          "bundle adjustment: observation of point {} by pose {}, but there are {} and {}", o.point,
          o.pose, points, poses));
    }
  }
}

std::vector<int> columns_of(const BundleProblem& problem) {
  const auto is_fixed = [](const BundleProblem::Pose& p) { return p.fixed; };
  const bool none_fixed = std::none_of(problem.poses.begin(), problem.poses.end(), is_fixed);
  std::vector<int> columns(problem.poses.size(), -1);
  int next = 0;
  for (std::size_t i = none_fixed ? 1 : 0; i < columns.size(); ++i) {
    if (!problem.poses[i].fixed) columns[i] = next++;
  }
  return columns;
}

bool is_usable(const BundleProblem& problem, const BundleProblem::Observation& o) {
  const SE3& T = problem.poses[o.pose].T_camera_world;
  return o.uvr_px.allFinite() && std::isfinite(o.inv_sigma2) && o.inv_sigma2 > 0.0 &&
         problem.points[o.point].allFinite() && T.translation().allFinite() &&
         T.rotation().coeffs().allFinite();
}

Layout::Entry entry_of(const BundleProblem& problem, int source, int column) {
  const BundleProblem::Observation& o = problem.observations[source];
  Layout::Entry e;
  e.pose = o.pose;
  e.column = column;
  e.source = source;
  e.stereo = o.uvr_px.z() >= 0.0;
  e.usable = is_usable(problem, o);
  e.uvr_px = o.uvr_px;
  e.inv_sigma2 = o.inv_sigma2;
  return e;
}

}  // namespace

State state_of(const BundleProblem& problem) {
  State state;
  for (const auto& pose : problem.poses) state.T_camera_world.push_back(pose.T_camera_world);
  state.points = problem.points;
  if (problem.inertial) state.inertial = problem.inertial->start;
  return state;
}

Layout make_layout(const BundleProblem& problem) {
  check_indices(problem);
  const std::vector<int> columns = columns_of(problem);
  Layout layout;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] >= 0) layout.pose_of_column.push_back(static_cast<int>(i));
  }
  layout.first.assign(problem.points.size() + 1, 0);
  for (const auto& o : problem.observations) ++layout.first[o.point + 1];
  for (std::size_t i = 1; i < layout.first.size(); ++i) layout.first[i] += layout.first[i - 1];
  layout.entries.resize(problem.observations.size());
  std::vector<int> next(layout.first.begin(), layout.first.end() - 1);
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    layout.entries[next[o.point]++] = entry_of(problem, static_cast<int>(i), columns[o.pose]);
  }
  const auto by_pose = [](const Layout::Entry& a, const Layout::Entry& b) {
    return a.pose != b.pose ? a.pose < b.pose : a.source < b.source;
  };
  for (int j = 0; j < layout.points(); ++j) {
    std::sort(layout.entries.begin() + layout.first[j],
              layout.entries.begin() + layout.first[j + 1], by_pose);
  }
  lay_out_inertial(problem, columns, layout);
  return layout;
}

NormalEquations linearise(const Intrinsics& k, const Layout& layout,
                          const std::vector<std::uint8_t>& active, const State& state,
                          const Loss& loss, NormalEquations reuse) {
  NormalEquations n = cleared(std::move(reuse), layout);
  const std::vector<Pose> poses = matrices_of(state.T_camera_world);
  double rho = 0.0;
  for (int j = 0; j < layout.points(); ++j) {
    for (int i = layout.first[j]; i < layout.first[j + 1]; ++i) {
      if (!active[i]) continue;
      const Layout::Entry& e = layout.entries[i];
      const Pose& pose = poses[e.pose];
      const Vector3d p = pose.rotation * state.points[j] + pose.translation;
      const PointTerms t = terms_of(k, e, p, loss);
      rho += t.rho;
      const Matrix3d by_world = t.hessian * pose.rotation;
      n.point_hessian[j].noalias() += pose.rotation.transpose() * by_world;
      n.point_gradient[j].noalias() += pose.rotation.transpose() * t.gradient;
      if (e.column < 0) continue;
      add_pose_terms(p, t, n.pose_hessian[e.column], n.pose_gradient[e.column]);
      n.coupling[i].topRows<3>() = by_world;
      n.coupling[i].bottomRows<3>() = cross_columns(p, by_world);
    }
  }
  n.cost = 0.5 * rho;
  if (layout.inertial) add_inertial(layout, state, n);
  return n;
}

double cost_of(const Intrinsics& k, const Layout& layout, const std::vector<std::uint8_t>& active,
               const State& state, const Loss& loss) {
  const std::vector<Pose> poses = matrices_of(state.T_camera_world);
  double rho = 0.0;
  for (int j = 0; j < layout.points(); ++j) {
    for (int i = layout.first[j]; i < layout.first[j + 1]; ++i) {
      if (!active[i]) continue;
      const Layout::Entry& e = layout.entries[i];
      const Vector3d p = poses[e.pose].rotation * state.points[j] + poses[e.pose].translation;
      rho += rho_of(chi2_of(k, e, p), gate_of(e, loss), loss.huber);
    }
  }
  return 0.5 * rho + (layout.inertial ? inertial_cost(layout, state) : 0.0);
}

std::vector<std::uint8_t> judge(const Intrinsics& k, const Layout& layout, const State& state,
                                const Loss& loss, double gates) {
  const std::vector<Pose> poses = matrices_of(state.T_camera_world);
  std::vector<std::uint8_t> active(layout.entries.size(), 0);
  for (int j = 0; j < layout.points(); ++j) {
    for (int i = layout.first[j]; i < layout.first[j + 1]; ++i) {
      const Layout::Entry& e = layout.entries[i];
      const Vector3d p = poses[e.pose].rotation * state.points[j] + poses[e.pose].translation;
      const bool good =
          e.usable && p.z() > kNearestDepthM &&
          e.inv_sigma2 * residual_px(k, e, p).squaredNorm() <= gates * gate_of(e, loss);
      active[i] = good ? 1 : 0;
    }
  }
  return active;
}

}  // namespace ydd::bundle
