// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/guard.h"

#include <exception>
#include <new>
#include <string>
#include <system_error>

namespace ydd {
namespace {

/// Texts of other libraries may have several lines.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

std::string reason() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const std::system_error& e) {  // no thread to be had, for example
    return one_line(std::string("the system refused: ") + e.what());
  } catch (const std::exception& e) {
    return one_line(std::string("internal: ") + e.what());
  } catch (...) {
    return "internal: something unknown was thrown";
  }
}

}  // namespace

Error current_exception_error(std::string_view where) noexcept {
  try {
    const std::string why = reason();
    return {where.empty() ? why : std::string(where) + ": " + why};
  } catch (...) {
    return {"out of memory"};  // short enough to be stored without any
  }
}

}  // namespace ydd
