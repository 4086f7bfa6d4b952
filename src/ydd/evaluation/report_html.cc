// SPDX-License-Identifier: Apache-2.0
#include "ydd/evaluation/report_html.h"

#include <span>
#include <tuple>
#include <utility>

#include "report_assets.inc"

namespace ydd {
namespace {

std::string joined(std::span<const std::string_view> pieces) {
  std::string out;
  for (const std::string_view piece : pieces) out += piece;
  return out;
}

/// `text` with every `mark` replaced, in one pass: what was filled in is not looked at again.
std::string filled(std::string_view text,
                   std::span<const std::pair<std::string_view, std::string>> marks) {
  std::string out;
  while (!text.empty()) {
    const auto at = text.find('@');
    out += text.substr(0, at);
    if (at == std::string_view::npos) break;
    text.remove_prefix(at);
    std::string_view taken = text.substr(0, 1), by = taken;
    for (const auto& [mark, content] : marks) {
      if (text.starts_with(mark)) std::tie(taken, by) = std::pair(mark, std::string_view(content));
    }
    out += by;
    text.remove_prefix(taken.size());
  }
  return out;
}

std::string replaced(std::string_view text, char what, std::string_view by) {
  std::string out;
  for (const char c : text) c == what ? out.append(by) : out.append(1, c);
  return out;
}

std::string html_text(std::string_view text) {
  return replaced(replaced(text, '&', "&amp;"), '<', "&lt;");
}

}  // namespace

std::string report_html(std::string_view title, std::string_view data_json, ReportPage page) {
  const std::pair<std::string_view, std::string> marks[] = {
      {"@TITLE@", html_text(title)},
      {"@LIBRARY_CSS@", joined(kLibraryCss)},
      {"@LIBRARY_JS@", joined(kLibraryJs)},
      {"@LICENCE@", joined(kLicence)},
      {"@COMMON_JS@", joined(kCommonJs)},
      {"@PAGE_JS@", page == ReportPage::one_run ? joined(kPageJs) : joined(kCompareJs)},
      // No HTML parser mistakes this for a tag: outside strings JSON has no '<' anyway.
      {"@DATA@", replaced(data_json, '<', "\\u003c")},
  };
  return filled(joined(kTemplate), marks);
}

}  // namespace ydd
