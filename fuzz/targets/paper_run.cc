// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/paper/run_figures.h"

namespace ydd::fuzz {

void paper_run(std::string_view input) {
  const auto run = parse_run_figures(input, "input");
  expect_one_line(run);
  if (!run) return;
  const std::string text = run_figures_json(*run);
  const auto again = parse_run_figures(text, "again");
  if (!again) broken("not read again: " + again.error().message);
  if (run_figures_json(*again) != text) broken("read again otherwise");
}

}  // namespace ydd::fuzz
