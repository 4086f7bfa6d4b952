// SPDX-License-Identifier: Apache-2.0
#include "ydd/paper/paper_style.h"

#include <string_view>

#include "paper_style.inc"

namespace ydd {

std::string paper_page_style() {
  std::string out;
  for (const std::string_view piece : kPageStyle) out += piece;
  return out;
}

}  // namespace ydd
