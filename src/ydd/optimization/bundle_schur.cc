// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_schur.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "ydd/optimization/tile_cholesky.h"

namespace ydd::bundle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Where nothing is observed the damped diagonal is still positive.
constexpr double kLeastDiagonal = 1e-9;

/// Inverse of the Cholesky factor of the damped 3x3 block: inverse(V) = F' F with F lower.
Matrix3d inverse_factor(const Matrix3d& hessian, double lambda) {
  const auto damped = [&](int i) { return hessian(i, i) * (1.0 + lambda) + kLeastDiagonal; };
  const auto root = [](double x) { return 1.0 / std::sqrt(std::max(x, kLeastDiagonal)); };
  const double i0 = root(damped(0));
  const double l10 = hessian(1, 0) * i0;
  const double l20 = hessian(2, 0) * i0;
  const double i1 = root(damped(1) - l10 * l10);
  const double l21 = (hessian(2, 1) - l20 * l10) * i1;
  const double i2 = root(damped(2) - l20 * l20 - l21 * l21);
  Matrix3d f = Matrix3d::Zero();
  f(0, 0) = i0;
  f(1, 1) = i1;
  f(2, 2) = i2;
  f(1, 0) = -l10 * i0 * i1;
  f(2, 1) = -l21 * i1 * i2;
  f(2, 0) = -(l20 * i0 + l21 * f(1, 0)) * i2;
  return f;
}

/// `block -= a * b'`. A column of six is taken as four and two, the widths that processors have;
/// left to itself Eigen takes three times two, and this is where most of the time goes.
void subtract_product(TileCholesky::Block block, const Matrix63d& a, const Matrix63d& b) {
  const Eigen::Matrix<double, 4, 3> top = a.topRows<4>();
  const Eigen::Matrix<double, 2, 3> bottom = a.bottomRows<2>();
  for (int c = 0; c < 6; ++c) {
    Eigen::Map<Eigen::Vector4d> upper(&block(0, c));
    Eigen::Map<Eigen::Vector2d> lower(&block(4, c));
    upper -= top.col(0) * b(c, 0) + top.col(1) * b(c, 1) + top.col(2) * b(c, 2);
    lower -= bottom.col(0) * b(c, 0) + bottom.col(1) * b(c, 1) + bottom.col(2) * b(c, 2);
  }
}

/// Poses that share a point are coupled.
TileCholesky::Pattern pattern_of(const Layout& layout) {
  TileCholesky::Pattern pattern(layout.columns());
  for (int j = 0; j < layout.points(); ++j) {
    for (int a = layout.first[j]; a < layout.first[j + 1]; ++a) {
      if (layout.entries[a].column < 0) continue;
      for (int b = layout.first[j]; b <= a; ++b) {
        if (layout.entries[b].column < 0) continue;
        pattern.add(layout.entries[a].column, layout.entries[b].column);
      }
    }
  }
  if (!layout.inertial) return pattern;
  for (const InertialLink& link : layout.inertial->links) {
    const int a = layout.column_of_pose[link.from], b = layout.column_of_pose[link.to];
    if (a >= 0 && b >= 0) pattern.add(std::max(a, b), std::min(a, b));
  }
  return pattern;
}

}  // namespace

/// The reduced system: S, lower blocks, and its right-hand side; scratch of the elimination.
struct SchurSolver::Reduced {
  explicit Reduced(const Layout& layout);

  void start(const NormalEquations& n, double lambda);
  void eliminate(const Layout& layout, const NormalEquations& n,
                 const std::vector<std::uint8_t>& active, int point, double lambda);
  std::optional<Eigen::VectorXd> factorise_and_solve();
  /// The same with a border, which stands behind the poses in the solution.
  std::optional<Eigen::VectorXd> factorise_and_solve(const Border& border, double lambda);

  int columns = 0;
  TileCholesky matrix;
  Eigen::VectorXd rhs;
  std::vector<Matrix3d> point_factor;  ///< inverse Cholesky factors
  std::vector<Matrix63d> eliminated;   ///< per entry of one point
  std::vector<int> eliminated_column;
};

SchurSolver::Reduced::Reduced(const Layout& layout)
    : columns(layout.columns()),
      matrix(pattern_of(layout)),
      rhs(6 * columns),
      point_factor(layout.points()) {}

void SchurSolver::Reduced::start(const NormalEquations& n, double lambda) {
  matrix.clear();
  for (int c = 0; c < columns; ++c) {
    auto block = matrix.block(c, c);
    block = n.pose_hessian[c];
    block.diagonal() *= 1.0 + lambda;
    block.diagonal().array() += kLeastDiagonal;
    rhs.segment<6>(6 * c) = -n.pose_gradient[c];
  }
  for (const Border::Pair& pair : n.border.pairs) {
    matrix.block(pair.row, pair.col) += pair.hessian;
  }
}

/// With V^-1 = F' F and Y = W F': S -= Y Y', rhs += Y F g. One product per pair of observations.
void SchurSolver::Reduced::eliminate(const Layout& layout, const NormalEquations& n,
                                     const std::vector<std::uint8_t>& active, int point,
                                     double lambda) {
  const Matrix3d& f = point_factor[point] = inverse_factor(n.point_hessian[point], lambda);
  const Vector3d fg = f * n.point_gradient[point];
  eliminated.clear();
  eliminated_column.clear();
  for (int i = layout.first[point]; i < layout.first[point + 1]; ++i) {
    const int column = layout.entries[i].column;
    if (column < 0 || !active[i]) continue;
    eliminated.push_back(n.coupling[i] * f.transpose());
    eliminated_column.push_back(column);
    rhs.segment<6>(6 * column).noalias() += eliminated.back() * fg;
  }
  for (std::size_t a = 0; a < eliminated.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const TileCholesky::Block block = matrix.block(eliminated_column[a], eliminated_column[b]);
      subtract_product(block, eliminated[a], eliminated[b]);
      if (a != b && eliminated_column[a] == eliminated_column[b]) {  // a pose sees the point twice
        subtract_product(block, eliminated[b], eliminated[a]);
      }
    }
  }
}

std::optional<Eigen::VectorXd> SchurSolver::Reduced::factorise_and_solve() {
  if (!matrix.factorise()) return std::nullopt;
  Eigen::VectorXd solution = matrix.solve(rhs);
  if (!solution.allFinite()) return std::nullopt;
  return solution;
}

std::optional<Eigen::VectorXd> SchurSolver::Reduced::factorise_and_solve(const Border& border,
                                                                         double lambda) {
  const std::optional<Eigen::VectorXd> poses = factorise_and_solve();
  if (!poses) return std::nullopt;
  Eigen::MatrixXd by_border(border.coupling.rows(), border.coupling.cols());
  for (Eigen::Index i = 0; i < by_border.cols(); ++i) {
    by_border.col(i) = matrix.solve(border.coupling.col(i));
  }
  Eigen::MatrixXd left = border.hessian;
  left.diagonal() *= 1.0 + lambda;
  left.diagonal().array() += kLeastDiagonal;
  left.noalias() -= border.coupling.transpose() * by_border;
  const Eigen::LLT<Eigen::MatrixXd> llt(left);
  if (llt.info() != Eigen::Success) return std::nullopt;
  Eigen::VectorXd solution(poses->size() + left.cols());
  solution.tail(left.cols()) = llt.solve(-border.gradient - border.coupling.transpose() * *poses);
  solution.head(poses->size()) = *poses - by_border * solution.tail(left.cols());
  if (!solution.allFinite()) return std::nullopt;
  return solution;
}

SchurSolver::SchurSolver(const Layout& layout)
    : layout_(layout), reduced_(std::make_unique<Reduced>(layout)) {}

SchurSolver::~SchurSolver() = default;

std::optional<Step> SchurSolver::solve(const NormalEquations& equations,
                                       const std::vector<std::uint8_t>& active, double lambda,
                                       const std::stop_token& stop) {
  reduced_->start(equations, lambda);
  for (int j = 0; j < layout_.points(); ++j) {
    reduced_->eliminate(layout_, equations, active, j, lambda);
  }
  if (stop.stop_requested()) return std::nullopt;
  const Border& border = equations.border;
  const auto solution = layout_.inertial ? reduced_->factorise_and_solve(border, lambda)
                                         : reduced_->factorise_and_solve();
  if (!solution || stop.stop_requested()) return std::nullopt;

  Step step;
  step.poses.resize(layout_.columns());
  step.points.resize(layout_.points());
  for (int c = 0; c < layout_.columns(); ++c) {
    const Vector6d& dx = step.poses[c] = solution->segment<6>(6 * c);
    const Vector6d damping = lambda * equations.pose_hessian[c].diagonal().cwiseProduct(dx);
    step.predicted_decrease += 0.5 * dx.dot(damping - equations.pose_gradient[c]);
  }
  for (int j = 0; j < layout_.points(); ++j) {
    Vector3d rest = -equations.point_gradient[j];
    for (int i = layout_.first[j]; i < layout_.first[j + 1]; ++i) {
      const int column = layout_.entries[i].column;
      if (column >= 0 && active[i]) rest -= equations.coupling[i].transpose() * step.poses[column];
    }
    const Matrix3d& f = reduced_->point_factor[j];
    const Vector3d& dp = step.points[j] = f.transpose() * (f * rest);
    const Vector3d damping = lambda * equations.point_hessian[j].diagonal().cwiseProduct(dp);
    step.predicted_decrease += 0.5 * dp.dot(damping - equations.point_gradient[j]);
  }
  if (!layout_.inertial) return step;
  step.border = solution->tail(layout_.border);
  const Eigen::VectorXd damping = lambda * border.hessian.diagonal().cwiseProduct(step.border);
  step.predicted_decrease += 0.5 * step.border.dot(damping - border.gradient);
  return step;
}

}  // namespace ydd::bundle
