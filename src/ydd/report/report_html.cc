// SPDX-License-Identifier: Apache-2.0
#include "ydd/report/report_html.h"

#include <cstdint>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

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

/// JSON inside a <script>: no parser of HTML or of scripts mistakes any of it for its own marks.
/// Outside of strings JSON has none of these characters.
std::string script_json(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string_view rest = json.substr(i, 3);
    if (json[i] == '<' || json[i] == '>' || json[i] == '&') {
      out += json[i] == '<' ? "\\u003c" : json[i] == '>' ? "\\u003e" : "\\u0026";
    } else if (rest == "\u2028" || rest == "\u2029") {
      out += rest.back() == '\xa8' ? "\\u2028" : "\\u2029";
      i += 2;
    } else {
      out += json[i];
    }
  }
  return out;
}

/// Names the page's own scripts to its policy, which lets no other run, handlers in attributes
/// included. The same for the same page (FNV-1a): reports of equal runs are equal.
std::string nonce_of(std::string_view data_json) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : data_json) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return fmt::format("{:016x}", hash);
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
      {"@NONCE@", nonce_of(data_json)},
      {"@DATA@", script_json(data_json)},
  };
  return filled(joined(kTemplate), marks);
}

}  // namespace ydd
