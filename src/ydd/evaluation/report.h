// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/base/result.h"
#include "ydd/evaluation/ate.h"
#include "ydd/evaluation/rpe.h"

namespace ydd {

/// How both errors are computed.
struct EvaluationOptions {
  AteOptions ate;
  RpeOptions rpe;  ///< its scale is replaced by the one that the alignment found
};

/// What there is to say about one trajectory.
struct Evaluation {
  EvaluationOptions options;
  std::size_t poses = 0;  ///< of the estimate
  AteResult ate;
  RpeResult rpe;  ///< empty when the trajectory is shorter than the interval
};

/// Both errors. Fails as `absolute_trajectory_error` does.
Result<Evaluation> evaluate(const StampedPoses& groundtruth, const StampedPoses& estimate,
                            const EvaluationOptions& options = {});

/// A table of fixed width with a line per error, six decimals; ends with a line break.
std::string format_table(const Evaluation& evaluation);

/// The same at full precision: {poses, ate: {pairs, alignment, scale,
/// absolute_translational_error: {rmse, mean, median, std, min, max}}, rpe: {pairs, delta, unit,
/// translational_error, rotational_error}}, metres and degrees; errors without pairs are null.
std::string format_json(const Evaluation& evaluation);

}  // namespace ydd
