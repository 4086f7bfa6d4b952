// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/one_line.h"

namespace ydd {

std::string on_one_line(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string out(text.substr(0, kLongest));
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  return text.size() > kLongest ? out + "..." : out;
}

}  // namespace ydd
