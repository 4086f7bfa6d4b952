// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/detection/detector_config.h"

namespace ydd::fuzz {

// The first line stands for the command line: --set with blanks between.
void detector(std::string_view input) {
  Pieces pieces(input);
  Pieces line(pieces.until('\n'));
  std::vector<std::string> overrides;
  while (!line.done()) overrides.emplace_back(line.until(' '));
  const auto config =
      read_detector_config(file_of(pieces.text(input.size()), "detector.yaml"), overrides);
  expect_one_line(config);
  if (!config) return;
  // What is in force can be read again.
  const auto again = read_detector_config(file_of(to_yaml(*config), "again.yaml"));
  if (!again) broken("not read again: " + again.error().message);
}

}  // namespace ydd::fuzz
