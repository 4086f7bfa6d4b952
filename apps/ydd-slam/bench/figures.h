// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "ydd/base/result.h"

namespace ydd::app {

/// What a bench gives: its table for people; first writes its figures as JSON to `out`, unless that
/// is empty.
Result<std::string> table_and_json(std::string table, const nlohmann::ordered_json& json,
                                   const std::string& out);

}  // namespace ydd::app
