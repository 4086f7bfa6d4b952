// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/base/result.h"

namespace ydd::app {

/// What --detector takes for "look at nothing".
inline constexpr const char* kNoDetector = "none";

/// The detector file of a command that names none: what the environment variable YDD_DETECTOR says
/// (a file, or `none`), else the network that comes with the program, from the folder it was
/// installed or built in. The failure says where it was looked for.
Result<std::string> default_detector();

/// Why that detector was taken, for whoever reads what is wrong with it: a part of a sentence.
std::string default_detector_origin();

}  // namespace ydd::app
