// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/alignment.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/LU>
#include <Eigen/SVD>

namespace ydd {
namespace {

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

std::optional<Alignment> align_points(std::span<const Eigen::Vector3d> source,
                                      std::span<const Eigen::Vector3d> target,
                                      AlignmentScale scale) {
  if (source.size() != target.size()) {
    throw std::logic_error("align_points: the point sets differ in length");
  }
  if (source.empty()) return std::nullopt;
  const double n = static_cast<double>(source.size());
  const Eigen::Vector3d source_mean = mean_of(source);
  const Eigen::Vector3d target_mean = mean_of(target);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // Umeyama's Sigma_xy, eq. (38)
  double source_variance = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d d = source[i] - source_mean;
    covariance += (target[i] - target_mean) * d.transpose();
    source_variance += d.squaredNorm();
  }
  covariance /= n;
  source_variance /= n;

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  // A reflection would fit better but is no motion: turn the weakest axis instead, eq. (39), (43).
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;
  const Eigen::Matrix3d rotation =
      svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();  // eq. (40)

  Alignment result;
  if (scale == AlignmentScale::estimated && source_variance > 0.0) {
    result.scale = svd.singularValues().dot(sign) / source_variance;  // eq. (42)
  }
  result.T_target_source = SE3(rotation, target_mean - result.scale * (rotation * source_mean));
  const Eigen::Vector3d& singular = svd.singularValues();
  const bool spread = source_variance > 1e-24 * source_mean.squaredNorm();  // beyond rounding
  result.unique = spread && source.size() >= 3 && singular.y() > 1e-9 * singular.x();
  double squared = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    squared += (target[i] - result * source[i]).squaredNorm();
  }
  result.rmse_m = std::sqrt(squared / n);
  return result;
}

}  // namespace ydd
