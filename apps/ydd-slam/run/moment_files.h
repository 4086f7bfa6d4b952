// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/pictures/key_moments.h"

namespace ydd::app {

/// Writes `moments` into the folder of a run, as moments/<frame>-<kind>.jpg and a list with their
/// captions, in place of those that an earlier run left there.
Result<void> write_moments(const std::filesystem::path& run,
                           const std::vector<FrameMoment>& moments);

/// What `write_moments` wrote; what is missing or broken is left out.
std::vector<KeyMoment> read_moments(const std::filesystem::path& run);

}  // namespace ydd::app
