// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "ydd/base/result.h"

namespace ydd {

/// The one way to read JSON: a text may come from anybody. Refused with one line "source: reason"
/// are text of more than 256 MiB, nesting of more than 64 levels (what walks through a value, or
/// writes it again, calls itself for each), and what is no JSON.
Result<nlohmann::ordered_json> parse_json(std::string_view text, std::string_view source);

}  // namespace ydd
