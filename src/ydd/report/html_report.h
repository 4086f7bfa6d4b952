// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/report.h"

namespace ydd {

/// A picture worth looking at.
struct KeyMoment {
  std::string caption;
  std::string jpeg;   ///< bytes of the file
  bool wide = false;  ///< two frames side by side
};

/// What a report is made of. JSON as `RunRecorder` tells it; empty texts and lists: not known.
struct RunReportData {
  std::string title;
  std::string summary_json, frames_json, timings_json;
  std::string tracks_jsonl;  ///< as `TrackRecorder` tells it: a line per frame
  std::string config;        ///< text of the effective configuration
  StampedPoses trajectory;
  StampedPoses groundtruth;
  std::optional<Evaluation> evaluation;  ///< of `trajectory` against `groundtruth`
  std::vector<KeyMoment> moments;
};

/// One HTML file that needs no other and no network: the page, the plotting library (dygraphs, MIT)
/// and the data. Whatever the data hold is text there, never markup. Fails on a text that is not
/// JSON and names it.
Result<std::string> html_report(const RunReportData& data);

/// The same for several runs and peers' trajectories of one sequence, side by side: each one's
/// title is its name, its own ground truth and moments are not looked at. A run is shown aligned to
/// `groundtruth` (may be empty) if it has an evaluation, else to the first. Fails as `html_report`.
Result<std::string> comparison_report(const std::string& title, const StampedPoses& groundtruth,
                                      std::span<const RunReportData> runs);

}  // namespace ydd
