// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "ydd/base/result.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/report.h"

namespace ydd::app {

/// Whether `folder` holds what a run leaves behind.
bool is_run_folder(const std::filesystem::path& folder);

/// Writes report.html into the folder of a run, from the files that are there already.
/// `groundtruth` may be empty; `evaluation` is of `trajectory` against it.
Result<void> write_run_report(const std::filesystem::path& folder, const StampedPoses& trajectory,
                              const StampedPoses& groundtruth,
                              const std::optional<Evaluation>& evaluation);

/// The same, evaluated here. Ground truth that cannot be used is worth a warning, not the run.
Result<void> write_run_report(const std::filesystem::path& folder, const StampedPoses& trajectory,
                              const std::optional<std::filesystem::path>& groundtruth_file);

}  // namespace ydd::app
