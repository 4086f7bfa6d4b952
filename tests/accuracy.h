// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/ate.h"

namespace ydd::e2e {

/// ATE RMSE in metres of the run in `out` against the truth of its sequence. Without a trajectory
/// the test fails, whatever it expects: no number is above or below NaN.
inline double ate_m(const std::filesystem::path& sequence, const std::filesystem::path& out) {
  const auto truth = read_tum_trajectory(sequence / "groundtruth.txt");
  const auto estimate = read_tum_trajectory(out / "trajectory.tum");
  if (!truth || !estimate) {
    ADD_FAILURE() << "no trajectory in " << out;
    return std::nan("");
  }
  const auto ate = absolute_trajectory_error(*truth, *estimate);
  if (!ate) ADD_FAILURE() << ate.error().message;
  return ate ? ate->statistics_m.rmse : std::nan("");
}

}  // namespace ydd::e2e
