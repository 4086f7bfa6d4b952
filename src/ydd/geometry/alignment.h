// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "ydd/geometry/se3.h"

namespace ydd {

/// A similarity `p_target = scale * R * p_source + t` between two point sets.
struct Alignment {
  SE3 T_target_source;  ///< rotation and translation
  double scale = 1.0;   ///< 1 unless it was asked for
  double rmse_m = 0.0;  ///< root of the mean squared distance after alignment
  /// Whether the points fix the rotation: at least three, not all on one line. Otherwise the
  /// distances are as small as can be, but the rotation is one choice among many.
  bool unique = false;

  /// A point of the source, in the frame of the target.
  Eigen::Vector3d operator*(const Eigen::Vector3d& p_source) const {
    return scale * (T_target_source.rotation() * p_source) + T_target_source.translation();
  }
};

/// What an alignment may change besides position and rotation.
enum class AlignmentScale {
  fixed,      ///< SE(3): metric maps (RGB-D)
  estimated,  ///< Sim(3)
};

/// The alignment with the least sum of squared distances between `target[i]` and the aligned
/// `source[i]` (metres, same order and length). Nothing for empty sets.
///
/// Source: S. Umeyama, Least-squares estimation of transformation parameters between two point
/// patterns, PAMI 13(4), 1991, eq. (38)-(42); the same optimum as Horn's for SE(3).
/// @throws std::logic_error if the lengths differ.
std::optional<Alignment> align_points(std::span<const Eigen::Vector3d> source,
                                      std::span<const Eigen::Vector3d> target,
                                      AlignmentScale scale = AlignmentScale::fixed);

}  // namespace ydd
