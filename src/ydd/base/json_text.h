// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace ydd {

/// The one way to write JSON. Names of folders and files need not be UTF-8, JSON must be: bytes
/// that are not become U+FFFD, where plain dump() would throw. `indent` < 0: all on one line.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace ydd
