// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace ydd {

/// What a stranger wrote, for the one line of an error: without control characters, and not longer
/// than fits there.
std::string on_one_line(std::string_view text);

}  // namespace ydd
