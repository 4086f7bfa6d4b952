// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/json_reader.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace ydd {
namespace {

constexpr std::size_t kLargestJson = std::size_t{256} << 20;
constexpr int kDeepestJson = 64;

/// Whether brackets outside of strings open more than kDeepestJson levels.
bool is_too_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestJson) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

}  // namespace

Result<nlohmann::ordered_json> parse_json(std::string_view text, std::string_view source) {
  if (text.size() > kLargestJson) {
    return Error{fmt::format("{}: {} bytes of JSON, more than can be ({})", source, text.size(),
                             kLargestJson)};
  }
  if (is_too_deep(text)) {
    return Error{fmt::format("{}: JSON nested in more than {} levels", source, kDeepestJson)};
  }
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    return Error{fmt::format("{}: not valid JSON at character {}", source, e.byte)};
  } catch (const nlohmann::json::exception&) {
    return Error{fmt::format("{}: a number in it is out of range", source)};
  }
}

}  // namespace ydd
