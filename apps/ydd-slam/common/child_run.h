// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "ydd/base/result.h"

namespace ydd::app {

/// What a run left in its folder.
struct ChildRun {
  nlohmann::ordered_json summary, timings;
};

/// What a process used until it ended.
struct ProcessUse {
  double wall_s = 0, cpu_s = 0;
  double virtual_mb = 0, resident_mb = 0;  ///< largest; 0: too short to tell
  double shared_mb = 0;                    ///< largest seen, every 50 ms
};

/// `ydd-slam` with these arguments in a process of its own; what it says goes to `log`. Failure:
/// its last line. When this process is asked to end, that one is too.
Result<ProcessUse> run_self(std::vector<std::string> arguments, const std::filesystem::path& log);

/// A run whose folder is still there.
struct KeptRun {
  ChildRun results;
  ProcessUse use;
};

/// `ydd-slam run` with these arguments in a process of its own. `folder` takes the results.
Result<KeptRun> run_in_child_keeping(std::vector<std::string> arguments,
                                     const std::filesystem::path& folder);

/// `ydd-slam run` with these arguments in a process of its own, so that its memory and start are
/// its own too. `folder` takes the results and is removed.
Result<ChildRun> run_in_child(std::vector<std::string> arguments,
                              const std::filesystem::path& folder);

/// Processor, cores, memory, system: what figures of speed depend on.
nlohmann::ordered_json machine_description();

}  // namespace ydd::app
