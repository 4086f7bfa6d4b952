// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/options.h"
#include "support.h"
#include "targets.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/geometry/camera.h"

namespace ydd::fuzz {
namespace {

/// Options of all kinds: numbers with ranges, choices, text, switches.
struct All {
  Camera camera;
  DynamicsOptions dynamics;
  void describe(OptionTable& table) {
    table.group("camera", camera);
    dynamics.describe(table);
  }
};

}  // namespace

void options(std::string_view input) {
  All all, again;
  OptionTable table, table_again;
  all.describe(table);
  again.describe(table_again);
  const auto read = table.load_yaml(file_of(input, "options.yaml"));
  expect_one_line(read);
  if (!read) return;
  const std::string text = table.to_yaml();
  const auto read_again = table_again.load_yaml(file_of(text, "again.yaml"));
  if (!read_again) broken("not read again: " + read_again.error().message);
  if (table_again.to_yaml() != text) broken("read again otherwise");
}

}  // namespace ydd::fuzz
