// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_schur.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

namespace ydd::bundle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Where nothing is observed the damped diagonal is still positive.
constexpr double kLeastDiagonal = 1e-9;
/// Up to this many free poses the dense factorisation is always the faster one.
constexpr int kDenseColumns = 80;
/// Beyond it, dense still wins when at least this share of pairs of poses shares a point.
constexpr double kDenseFill = 0.6;

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

}  // namespace

/// The reduced system: S, upper blocks only, and its right-hand side.
struct SchurSolver::Reduced {
  explicit Reduced(const Layout& layout);

  int& index(int row, int col) { return block_of[static_cast<std::size_t>(row) * columns + col]; }
  bool is_dense() const { return sparse.size() == 0; }

  void start(const NormalEquations& n, double lambda);
  void eliminate(const Layout& layout, const NormalEquations& n,
                 const std::vector<std::uint8_t>& active, int point, double lambda);
  std::optional<Eigen::VectorXd> factorise_and_solve();

  int columns = 0;
  std::vector<int> block_of;  ///< columns x columns; -1: no common point
  std::vector<Matrix6d> blocks;
  Eigen::VectorXd rhs;
  std::vector<Matrix3d> point_factor;  ///< inverse Cholesky factors
  std::vector<Matrix63d> eliminated;   ///< scratch, per entry of one point
  std::vector<int> eliminated_column;

  Eigen::MatrixXd dense;
  Eigen::SparseMatrix<double> sparse;  ///< upper blocks, whole columns of each
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Upper> sparse_solver;

 private:
  void find_blocks(const Layout& layout);
  void prepare_sparse();
  std::optional<Eigen::VectorXd> solve_dense();
  std::optional<Eigen::VectorXd> solve_sparse();
};

SchurSolver::Reduced::Reduced(const Layout& layout) : columns(layout.columns()) {
  find_blocks(layout);
  rhs.resize(6 * columns);
  point_factor.resize(layout.points());
  const double pairs = 0.5 * columns * (columns + 1.0);
  if (columns > kDenseColumns && static_cast<double>(blocks.size()) < kDenseFill * pairs) {
    prepare_sparse();
  } else {
    dense.resize(6 * columns, 6 * columns);
  }
}

void SchurSolver::Reduced::find_blocks(const Layout& layout) {
  block_of.assign(static_cast<std::size_t>(columns) * columns, -1);
  for (int c = 0; c < columns; ++c) index(c, c) = 0;
  for (int j = 0; j < layout.points(); ++j) {
    for (int a = layout.first[j]; a < layout.first[j + 1]; ++a) {
      if (layout.entries[a].column < 0) continue;
      for (int b = a + 1; b < layout.first[j + 1]; ++b) {
        if (layout.entries[b].column < 0) continue;
        index(layout.entries[a].column, layout.entries[b].column) = 0;
      }
    }
  }
  int count = 0;
  for (int& i : block_of) {
    if (i == 0) i = count++;
  }
  blocks.resize(count);
}

/// All six rows of every upper block take part, diagonal blocks too: one pattern, simple copies.
void SchurSolver::Reduced::prepare_sparse() {
  sparse.resize(6 * columns, 6 * columns);
  std::vector<Eigen::Triplet<double>> triplets;
  for (int col = 0; col < columns; ++col) {
    for (int row = 0; row <= col; ++row) {
      if (index(row, col) < 0) continue;
      for (int c = 0; c < 6; ++c) {
        for (int r = 0; r < 6; ++r) triplets.emplace_back(6 * row + r, 6 * col + c, 1.0);
      }
    }
  }
  sparse.setFromTriplets(triplets.begin(), triplets.end());
  sparse_solver.analyzePattern(sparse);
}

void SchurSolver::Reduced::start(const NormalEquations& n, double lambda) {
  for (Matrix6d& block : blocks) block.setZero();
  for (int c = 0; c < columns; ++c) {
    Matrix6d& block = blocks[index(c, c)];
    block = n.pose_hessian[c];
    block.diagonal() *= 1.0 + lambda;
    block.diagonal().array() += kLeastDiagonal;
    rhs.segment<6>(6 * c) = -n.pose_gradient[c];
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
    const int row = eliminated_column[a];
    for (std::size_t b = a; b < eliminated.size(); ++b) {
      Matrix6d& block = blocks[index(row, eliminated_column[b])];
      block.noalias() -= eliminated[a].lazyProduct(eliminated[b].transpose());
      if (b != a && eliminated_column[b] == row) {  // one pose sees the point twice
        block.noalias() -= eliminated[b].lazyProduct(eliminated[a].transpose());
      }
    }
  }
}

std::optional<Eigen::VectorXd> SchurSolver::Reduced::factorise_and_solve() {
  auto solution = is_dense() ? solve_dense() : solve_sparse();
  if (solution && !solution->allFinite()) return std::nullopt;
  return solution;
}

std::optional<Eigen::VectorXd> SchurSolver::Reduced::solve_dense() {
  dense.setZero();
  for (int col = 0; col < columns; ++col) {
    for (int row = 0; row <= col; ++row) {
      const int i = index(row, col);
      if (i >= 0) dense.block<6, 6>(6 * col, 6 * row) = blocks[i].transpose();
    }
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> llt(dense);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return llt.solve(rhs);
}

std::optional<Eigen::VectorXd> SchurSolver::Reduced::solve_sparse() {
  for (int col = 0; col < columns; ++col) {
    for (int c = 0; c < 6; ++c) {
      double* value = sparse.valuePtr() + sparse.outerIndexPtr()[6 * col + c];
      for (int row = 0; row <= col; ++row) {
        const int i = index(row, col);
        if (i < 0) continue;
        for (int r = 0; r < 6; ++r) *value++ = blocks[i](r, c);
      }
    }
  }
  sparse_solver.factorize(sparse);
  if (sparse_solver.info() != Eigen::Success) return std::nullopt;
  return Eigen::VectorXd(sparse_solver.solve(rhs));
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
  const auto solution = reduced_->factorise_and_solve();
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
  return step;
}

}  // namespace ydd::bundle
