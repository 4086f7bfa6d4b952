// SPDX-License-Identifier: Apache-2.0
#include <set>

#include "support.h"
#include "targets.h"
#include "ydd/detection/class_table.h"

namespace ydd::fuzz {

void class_table(std::string_view input) {
  const auto names = read_class_table(file_of(input, "classes.yaml"));
  expect_one_line(names);
  if (!names) return;
  if (names->empty() || names->size() != std::set(names->begin(), names->end()).size()) {
    broken("no class, or one twice");
  }
}

}  // namespace ydd::fuzz
