// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace ydd {

/// Which script draws the data.
enum class ReportPage { one_run, comparison };

/// One HTML file: the page's template with plotting library, scripts, `title` and `data_json`
/// (UTF-8) filled in. Both are text there, never markup.
std::string report_html(std::string_view title, std::string_view data_json, ReportPage page);

}  // namespace ydd
