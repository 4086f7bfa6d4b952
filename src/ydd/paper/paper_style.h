// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ydd {

/// The style sheet of the page, paper_page.css.
std::string paper_page_style();

}  // namespace ydd
