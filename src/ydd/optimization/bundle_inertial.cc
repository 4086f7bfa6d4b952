// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_inertial.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace ydd::bundle {
namespace {

using inertial_order::kAll;
using inertial_order::kFrom;
using inertial_order::kGlobal;
using inertial_order::kGlobals;
using inertial_order::kSpeedFrom;
using inertial_order::kSpeedTo;
using inertial_order::kTo;

constexpr double kLinkGate = 16.919;  // chi-square of nine, 95 %
// No IMU is as good as its white noise alone: scale, alignment, what happens between two samples.
constexpr double kLeastTurn_rad = 1e-4, kLeastSpeed_m_s = 1e-3, kLeastShift_m = 1e-4;

Matrix9d information_of(const InertialMeasurement& m) {
  Matrix9d covariance = m.covariance;
  covariance.diagonal().head<3>().array() += kLeastTurn_rad * kLeastTurn_rad;
  covariance.diagonal().segment<3>(3).array() += kLeastSpeed_m_s * kLeastSpeed_m_s;
  covariance.diagonal().tail<3>().array() += kLeastShift_m * kLeastShift_m;
  const Matrix9d information = covariance.ldlt().solve(Matrix9d::Identity());
  if (!information.allFinite()) return Matrix9d::Zero();
  return 0.5 * (information + information.transpose());
}

LinkError error_at(const Layout& layout, const State& state, std::size_t link) {
  const InertialProblem& problem = *layout.inertial;
  const InertialLink& l = problem.links[link];
  return link_error(problem, l, state.T_camera_world[static_cast<std::size_t>(l.from)],
                    state.T_camera_world[static_cast<std::size_t>(l.to)], state.inertial);
}

/// How biases and gravity differ from the prior, in its standard deviations.
using Globals = Eigen::Matrix<double, kGlobals, 1>;
Globals prior_error(const InertialProblem& problem, const InertialUnknowns& x) {
  const Eigen::Vector3d before = problem.start.gravity_m_s2.normalized();
  const Eigen::Vector3d turn = before.cross(x.gravity_m_s2.normalized());
  Globals e;
  e << (x.gyro_bias_rad_s - problem.start.gyro_bias_rad_s) / problem.gyro_bias_sigma_rad_s,
      (x.accel_bias_m_s2 - problem.start.accel_bias_m_s2) / problem.accel_bias_sigma_m_s2,
      axes_across(x.gravity_m_s2).transpose() * turn / problem.gravity_sigma_rad;
  return e;
}

Globals prior_jacobian(const InertialProblem& problem, const InertialUnknowns& x) {
  const double along = problem.start.gravity_m_s2.normalized().dot(x.gravity_m_s2.normalized());
  Globals j;
  j << Eigen::Vector3d::Constant(1.0 / problem.gyro_bias_sigma_rad_s),
      Eigen::Vector3d::Constant(1.0 / problem.accel_bias_sigma_m_s2),
      Eigen::Vector2d::Constant(along / problem.gravity_sigma_rad);
  return j;
}

/// Where the parts of a link stand: in the poses' columns (-1: fixed) or in the border.
struct Part {
  int at = 0, size = 0;
  int column = -1, border = -1;
};

std::array<Part, 5> parts_of(const Layout& layout, const InertialLink& link) {
  const auto from = static_cast<std::size_t>(link.from), to = static_cast<std::size_t>(link.to);
  return {{{kFrom, 6, layout.column_of_pose[from], -1},
           {kTo, 6, layout.column_of_pose[to], -1},
           {kSpeedFrom, 3, -1, layout.speed_at[from]},
           {kSpeedTo, 3, -1, layout.speed_at[to]},
           {kGlobal, kGlobals, -1, layout.border - kGlobals}}};
}

using LinkHessian = Eigen::Matrix<double, kAll, kAll>;
using LinkGradient = Eigen::Matrix<double, kAll, 1>;

void add_link(const Layout& layout, const InertialLink& link, const LinkHessian& H,
              const LinkGradient& g, NormalEquations& n) {
  const std::array<Part, 5> parts = parts_of(layout, link);
  Border& border = n.border;
  for (const Part& a : parts) {
    if (a.column >= 0) {
      n.pose_hessian[static_cast<std::size_t>(a.column)] += H.block<6, 6>(a.at, a.at);
      n.pose_gradient[static_cast<std::size_t>(a.column)] += g.segment<6>(a.at);
    }
    if (a.border >= 0) border.gradient.segment(a.border, a.size) += g.segment(a.at, a.size);
    for (const Part& b : parts) {
      const auto block = H.block(a.at, b.at, a.size, b.size);
      if (a.border >= 0 && b.border >= 0) {
        border.hessian.block(a.border, b.border, a.size, b.size) += block;
      } else if (a.column >= 0 && b.border >= 0) {
        border.coupling.block(6 * a.column, b.border, 6, b.size) += block;
      } else if (a.column > b.column && b.column >= 0) {
        border.pairs.push_back({a.column, b.column, block});
      }
    }
  }
}

}  // namespace

void lay_out_inertial(const BundleProblem& problem, const std::vector<int>& columns,
                      Layout& layout) {
  if (!problem.inertial || problem.inertial->links.empty()) return;
  const auto poses = static_cast<int>(columns.size());
  layout.inertial = &*problem.inertial;
  layout.column_of_pose = columns;
  layout.speed_at.assign(columns.size(), -1);
  if (problem.inertial->start.speed_m_s.size() != columns.size()) {
    throw std::logic_error("bundle adjustment: not as many speeds as poses");
  }
  for (const InertialLink& link : problem.inertial->links) {
    if (link.from < 0 || link.to < 0 || link.from >= poses || link.to >= poses ||
        link.from == link.to) {
      throw std::logic_error("bundle adjustment: an inertial link of poses that are not there");
    }
    for (const int pose : {link.from, link.to}) {
      int& at = layout.speed_at[static_cast<std::size_t>(pose)];
      if (at >= 0) continue;
      at = layout.border;
      layout.border += 3;
    }
    layout.link_information.push_back(information_of(link.measured));
  }
  layout.border += kGlobals;
}

void add_inertial(const Layout& layout, const State& state, NormalEquations& n) {
  Border& border = n.border;
  border.hessian.setZero(layout.border, layout.border);
  border.gradient.setZero(layout.border);
  border.coupling.setZero(6 * layout.columns(), layout.border);
  border.pairs.clear();
  const InertialProblem& problem = *layout.inertial;
  for (std::size_t i = 0; i < problem.links.size(); ++i) {
    const LinkError e = error_at(layout, state, i);
    const double chi2 = e.residual.dot(layout.link_information[i] * e.residual);
    const double weight = chi2 > kLinkGate ? std::sqrt(kLinkGate / chi2) : 1.0;
    const Eigen::Matrix<double, kAll, 9> JtW =
        weight * e.jacobian.transpose() * layout.link_information[i];
    add_link(layout, problem.links[i], JtW * e.jacobian, JtW * e.residual, n);
  }
  const Globals e = prior_error(problem, state.inertial);
  const Globals j = prior_jacobian(problem, state.inertial);
  border.gradient.tail<kGlobals>() += j.cwiseProduct(e);
  border.hessian.diagonal().tail<kGlobals>() += j.cwiseAbs2();
  n.cost += inertial_cost(layout, state);
}

double inertial_cost(const Layout& layout, const State& state) {
  double rho = prior_error(*layout.inertial, state.inertial).squaredNorm();
  for (std::size_t i = 0; i < layout.inertial->links.size(); ++i) {
    const LinkError e = error_at(layout, state, i);
    const double chi2 = e.residual.dot(layout.link_information[i] * e.residual);
    rho += chi2 > kLinkGate ? 2.0 * std::sqrt(kLinkGate * chi2) - kLinkGate : chi2;
  }
  return 0.5 * rho;
}

InertialUnknowns moved(const Layout& layout, const InertialUnknowns& x,
                       const Eigen::VectorXd& step) {
  InertialUnknowns next = x;
  for (std::size_t pose = 0; pose < layout.speed_at.size(); ++pose) {
    if (layout.speed_at[pose] >= 0) next.speed_m_s[pose] += step.segment<3>(layout.speed_at[pose]);
  }
  const Globals globals = step.tail<kGlobals>();
  next.gyro_bias_rad_s += globals.head<3>();
  next.accel_bias_m_s2 += globals.segment<3>(3);
  next.gravity_m_s2 = so3_exp(axes_across(x.gravity_m_s2) * globals.tail<2>()) * x.gravity_m_s2;
  return next;
}

}  // namespace ydd::bundle
