// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_page.h"

#include <span>
#include <string_view>
#include <utility>

#include "live_assets.inc"

namespace ydd {
namespace {

std::string joined(std::span<const std::string_view> pieces) {
  std::string out;
  for (const std::string_view piece : pieces) out += piece;
  return out;
}

std::string replaced(std::string text, std::string_view mark, const std::string& by) {
  const auto at = text.find(mark);
  return at == std::string::npos ? text : text.replace(at, mark.size(), by);
}

}  // namespace

std::string live_page() {
  // The template has each mark once, before anything is filled in that could look like one.
  std::string page = replaced(joined(kTemplate), "@PAGE_JS@", joined(kPageJs));
  page = replaced(std::move(page), "@LICENCE@", joined(kLicence));
  page = replaced(std::move(page), "@LIBRARY_CSS@", joined(kLibraryCss));
  return replaced(std::move(page), "@LIBRARY_JS@", joined(kLibraryJs));
}

}  // namespace ydd
