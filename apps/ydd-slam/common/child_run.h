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

/// `ydd-slam run` with these arguments in a process of its own, so that its memory and start are
/// its own too. `folder` takes the results and is removed.
Result<ChildRun> run_in_child(std::vector<std::string> arguments,
                              const std::filesystem::path& folder);

/// Processor, cores, memory, system: what figures of speed depend on.
nlohmann::ordered_json machine_description();

}  // namespace ydd::app
