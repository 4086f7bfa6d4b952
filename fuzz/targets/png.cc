// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/image/decode.h"
#include "ydd/image/png_encoder.h"

namespace ydd::fuzz {

void png(std::string_view input) {
  const auto file = file_of(input, "picture.png");
  expect_one_line(load_colour(file));
  expect_one_line(load_raw_depth(file));
  if (png_text(input).size() > input.size()) broken("a note from beyond the file");
}

}  // namespace ydd::fuzz
