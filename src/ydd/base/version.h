// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ydd {
inline constexpr const char* kVersion = "0.1.0";  ///< Of the whole project, major.minor.patch.
}
