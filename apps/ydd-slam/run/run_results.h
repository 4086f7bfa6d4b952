// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run/run_configuration.h"
#include "run/run_play.h"

namespace ydd::app {

/// What is written of a run that has ended.
struct RunResults {
  const RunRequest& request;
  const Configuration& configuration;
  const Sequence& sequence;
  const ObjectCatalogue& catalogue;
  SlamSystem& system;
  Listeners& listeners;
  const PlayEnd& end;
  std::filesystem::path folder;
  bool has_detector = false;
  std::string detector_device;  ///< of its networks
  std::string summary;
  std::optional<std::filesystem::path> groundtruth_file;  ///< in TUM's format
};

/// Collects what could not be written: whatever fails, the next result is still tried.
class Attempts {
 public:
  /// An exception counts as a failure.
  void attempt(const std::function<Result<void>()>& step);
  /// All in one line; empty: none failed.
  std::string failures() const;

 private:
  std::vector<std::string> failures_;
};

/// The file with the truth in TUM's format: the recording's own, or one made of its poses in the
/// results' folder. Nothing: there is no truth, or it cannot be read, which is warned of.
std::optional<std::filesystem::path> place_groundtruth(const RunResults& results,
                                                       Attempts& attempts);

std::string summary_of(const RunResults& results, double wall_s);

/// Trajectory first, then what explains it, the map, and last the report with its pictures: what
/// is worth most is written before what may fail.
void write_results(const RunResults& results, Attempts& attempts);

}  // namespace ydd::app
