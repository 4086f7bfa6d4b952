// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/studies/point_decisions.h"

namespace ydd::app {

/// A sequence to measure on, with the boxes to use.
struct BenchCase {
  std::string name;
  std::filesystem::path folder;
  std::filesystem::path detections;  ///< recording; empty: no boxes
};

/// What the bench commands have in common.
struct BenchRequest {
  std::vector<std::string> sequences;
  int simulated = 0;  ///< busy rooms to render and add, seeds 1, 2, ...
  int simulated_frames = 200;
  std::string detector;  ///< detector file; empty: recorded boxes beside the sequence; none: blind
  std::vector<std::string> detector_set;  ///< key=value for the detector
  std::string detect;        ///< of speed: every-frame or asynchronous; empty: as configured
  bool boxes_needed = true;  ///< a sequence without boxes is an error
  int runs = 5;
  std::string out;  ///< JSON file; empty: none
  std::vector<std::string> set;
  std::vector<std::string> against;  ///< of speed: what configuration B sets beyond A

  bool blind() const;  ///< nothing is detected
};

/// The cases of a request: sequences as given, simulated rooms rendered into `scratch`, detections
/// recorded with the detector into `scratch` if there is one.
Result<std::vector<BenchCase>> prepare_cases(const BenchRequest& request,
                                             const std::filesystem::path& scratch);

/// Those of `variants` that can be told apart by a request: blind, the ones that do without boxes.
std::vector<Variant> variants_of(const BenchRequest& request, std::vector<Variant> variants);

/// ATE and RPE of the variants on every case, median of several runs, as a Markdown table.
Result<std::string> bench_ablation(const BenchRequest& request,
                                   const std::filesystem::path& scratch);

/// Recall and precision of the rejected points of every variant against the moving masks.
Result<std::string> bench_dynamics(const BenchRequest& request,
                                   const std::filesystem::path& scratch);

/// Judges the points of a sequence that has a folder `mask` (decide_points).
Result<PointDecisions> judge_sequence(const BenchCase& bench_case, Variant variant,
                                      const std::vector<std::string>& set, int latency_frames);

/// ATE of a sequence against its ground truth, in metres, per run that could be scored.
Result<std::vector<double>> ate_of_runs(const BenchCase& bench_case, const BenchRequest& request,
                                        const std::vector<std::string>& set,
                                        const std::filesystem::path& scratch);

/// What asynchronous detection costs: ATE, recall and precision of point decisions for boxes of
/// every frame and for a detector that needs 1, 2, 4, 8 frames.
Result<std::string> bench_detection(const BenchRequest& request,
                                    const std::filesystem::path& scratch);

/// What faults of a detector cost: ATE with exact boxes, with none every other second, without the
/// nearest person, with persons called chairs, and with none.
Result<std::string> bench_boxes(const BenchRequest& request, const std::filesystem::path& scratch);

/// Time per frame and stage, frames dropped and late, memory and energy, flat out and in real
/// time, each run in a process of its own; with `against` as pairs A B A B.
Result<std::string> bench_speed(const BenchRequest& request, const std::filesystem::path& scratch);

}  // namespace ydd::app
