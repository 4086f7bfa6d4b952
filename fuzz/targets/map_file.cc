// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_file.h"
#include "support.h"
#include "targets.h"

namespace ydd::fuzz {

void map_file(std::string_view input) {
  const Result<Atlas> atlas = load_map(file_of(input, "input.map"));
  expect_one_line(atlas);
  if (atlas && !atlas->check_consistency().empty()) broken("links that do not hold");
}

}  // namespace ydd::fuzz
