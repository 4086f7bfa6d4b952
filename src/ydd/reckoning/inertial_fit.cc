// SPDX-License-Identifier: Apache-2.0
#include "ydd/reckoning/inertial_fit.h"

#include <Eigen/Cholesky>

namespace ydd {
namespace {

constexpr double kGravity_m_s2 = 9.81;
constexpr double kGravitySigma_m_s2 = 0.03;  // differs over the earth
constexpr double kBiasSigma_m_s2 = 0.3;      // of accelerometers as they are sold
constexpr double kSeenSigma_m = 0.006;       // of one seen place to the next
constexpr double kGainSigma_m_s = 0.002;     // over a tenth of a second, by noise and tilt
constexpr std::size_t kLeastNodes = 4;

/// Normal equations in the speeds of all nodes, gravity and bias.
struct NormalEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  explicit NormalEquations(Eigen::Index n)
      : H(Eigen::MatrixXd::Zero(n, n)), b(Eigen::VectorXd::Zero(n)) {}
  void add(const Eigen::MatrixXd& rows, const Eigen::VectorXd& wanted, double sigma) {
    const double weight = 1.0 / (sigma * sigma);
    H.noalias() += weight * rows.transpose() * rows;
    b.noalias() += weight * rows.transpose() * wanted;
  }
};

NormalEquations equations_of(std::span<const InertialNode> nodes,
                             std::span<const Preintegrated> between) {
  const auto speeds = static_cast<Eigen::Index>(3 * nodes.size());
  NormalEquations out(speeds + 6);
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Preintegrated& sum = between[k];
    const double dt_s = sum.duration_s;
    const Eigen::Matrix3d R = nodes[k].T_world_imu.rotation_matrix();
    const auto at = static_cast<Eigen::Index>(3 * k);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, speeds + 6);
    rows.middleCols(at, 3) = dt_s * I;
    rows.middleCols(speeds, 3) = 0.5 * dt_s * dt_s * I;
    rows.middleCols(speeds + 3, 3) = R * sum.shift_by_bias;
    out.add(rows,
            nodes[k + 1].T_world_imu.translation() - nodes[k].T_world_imu.translation() -
                R * sum.shift_m,
            kSeenSigma_m);
    rows.setZero();
    rows.middleCols(at, 3) = -I;
    rows.middleCols(at + 3, 3) = I;
    rows.middleCols(speeds, 3) = -dt_s * I;
    rows.middleCols(speeds + 3, 3) = -R * sum.speed_by_bias;
    out.add(rows, R * sum.speed_m_s, kGainSigma_m_s);
  }
  return out;
}

/// What the equations say of gravity and bias, whatever the speeds are.
InertialPrior without_speeds(const NormalEquations& all) {
  const Eigen::Index speeds = all.b.size() - 6;
  const Eigen::MatrixXd H_vv =
      all.H.topLeftCorner(speeds, speeds) + 1e-6 * Eigen::MatrixXd::Identity(speeds, speeds);
  const Eigen::MatrixXd H_vg = all.H.topRightCorner(speeds, 6);
  const Eigen::LDLT<Eigen::MatrixXd> solver(H_vv);
  InertialPrior out;
  out.information = all.H.bottomRightCorner<6, 6>() - H_vg.transpose() * solver.solve(H_vg);
  out.sum = all.b.tail<6>() - H_vg.transpose() * solver.solve(all.b.head(speeds));
  return out;
}

}  // namespace

std::optional<InertialFit> fit_inertial(std::span<const InertialNode> nodes,
                                        std::span<const Preintegrated> between,
                                        const InertialPrior& prior) {
  if (nodes.size() < kLeastNodes) return std::nullopt;
  const NormalEquations seen = equations_of(nodes, between);
  const Eigen::Index speeds = seen.b.size() - 6;
  InertialFit fit;
  fit.learnt = without_speeds(seen);
  NormalEquations all = seen;
  all.H.bottomRightCorner<6, 6>() += prior.information;
  all.b.tail<6>() += prior.sum;
  all.H.bottomRightCorner<3, 3>().diagonal().array() += 1.0 / (kBiasSigma_m_s2 * kBiasSigma_m_s2);
  Eigen::VectorXd x = all.H.ldlt().solve(all.b);
  for (int round = 0; round < 2; ++round) {  // the length of gravity, about its direction
    NormalEquations known = all;
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, x.size());
    row.middleCols(speeds, 3) = x.segment<3>(speeds).normalized().transpose();
    known.add(row, Eigen::VectorXd::Constant(1, kGravity_m_s2), kGravitySigma_m_s2);
    x = known.H.ldlt().solve(known.b);
  }
  if (!x.allFinite()) return std::nullopt;
  fit.state = {x.segment<3>(speeds), x.tail<3>()};
  fit.speed_m_s = x.segment<3>(speeds - 3);
  return fit;
}

}  // namespace ydd
