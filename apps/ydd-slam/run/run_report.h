// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "ydd/base/result.h"
#include "ydd/report/html_report.h"

namespace ydd::app {

/// Whether `folder` holds what a run leaves behind.
bool is_run_folder(const std::filesystem::path& folder);

/// What a run left in its folder, except its trajectory. Older runs lack some files: then their
/// report lacks what these would tell.
RunReportData read_run(const std::filesystem::path& folder);

/// The sequence that a run was on.
std::string sequence_of(const RunReportData& run);
/// The ground truth that the sequence had; nothing if it had none or the run is too old to tell.
std::optional<std::filesystem::path> groundtruth_file_of(const RunReportData& run);

/// Adds ground truth, and the errors of the trajectory against it. Ground truth that cannot be used
/// is worth a warning, not the run.
void add_groundtruth(const std::filesystem::path& file, RunReportData& data);

Result<void> write_run_report(const RunReportData& data, const std::filesystem::path& file);

}  // namespace ydd::app
