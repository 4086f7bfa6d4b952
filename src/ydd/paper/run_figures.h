// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "ydd/base/result.h"
#include "ydd/dataset/trajectory.h"

namespace ydd {

/// What a run is drawn from.
struct RunCurves {
  std::vector<Eigen::Vector3d> truth_m, estimate_m;  ///< pair by pair, in the truth's world
  std::vector<double> rpe_stamp_s, rpe_m;            ///< from the first pose on; per pair of frames
  std::vector<double> requested;                     ///< features asked for, per frame
};

/// What one run of one variant on one sequence gave, of whatever system.
struct RunFigures {
  std::string settings;  ///< what else a run depends on: those of others are not reused
  std::string sequence, variant;
  int run = 1;  ///< 1, 2, ...
  std::map<std::string, double>
      values;  ///< by FigureSource::key(); what could not be had is not there
  RunCurves curves;
};

/// Adds ATE and RPE of `trajectory` to `run`. The RPE is that of consecutive frames, and its
/// rotation is unit-less, || R - I || in Frobenius' norm = 2 sqrt(2) sin(angle / 2): the article
/// does not say so, but its figures are of that size, and "unit-less" is what the tool of M. Grupp
/// (evo, "rotation_part") calls that norm. Nothing is added where too few poses have a truth.
void score_trajectory(const StampedPoses& truth, const StampedPoses& trajectory, RunFigures& run);

/// JSON of a run, on one line, and back. Failure: one line that begins with `origin`.
std::string run_figures_json(const RunFigures& run);
Result<RunFigures> parse_run_figures(std::string_view json, std::string_view origin);

}  // namespace ydd
