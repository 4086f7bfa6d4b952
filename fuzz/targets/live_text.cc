// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/live/live_control.h"
#include "ydd/live/live_server.h"

namespace ydd::fuzz {

// What people write: an address on the command line, and a command.
void live_text(std::string_view input) {
  Pieces pieces(input);
  const std::string_view address = pieces.until('\n');
  const std::string token(pieces.until('\n'));
  expect_one_line(parse_live_address(address, token));
  const auto command = parse_live_command(pieces.text(input.size()));
  expect_one_line(command);
  if (command && !parse_live_command(to_string(*command))) broken("a command is not read again");
}

}  // namespace ydd::fuzz
