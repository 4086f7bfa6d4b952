// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands.h"
#include "ydd/geometry/camera.h"

namespace ydd::app {

void add_options_command(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("options", "List every option with default, unit and range");
  command->footer("Example:\n  ydd-slam options > my.yaml && ydd-slam run SEQUENCE --config my.yaml");
  command->callback([&job] {
    job = []() -> Result<void> {
      Camera camera;
      OptionTable table;
      camera.describe(table);
      fmt::print("{}", table.to_yaml());
      return {};
    };
  });
}

}  // namespace ydd::app
