// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_control.h"

#include <chrono>

#include <fmt/format.h>

#include "ydd/base/one_line.h"

namespace ydd {
namespace {

constexpr std::string_view kVariant = "variant ";

struct Tell {
  std::string operator()(live::Pause) const { return "pause"; }
  std::string operator()(live::Resume) const { return "resume"; }
  std::string operator()(live::Step) const { return "step"; }
  std::string operator()(live::Reset) const { return "reset"; }
  std::string operator()(live::SetVariant set) const {
    return fmt::format("{}{}", kVariant, to_string(set.variant));
  }
  std::string operator()(live::SetLocalizationOnly set) const {
    return set.on ? "localize on" : "localize off";
  }
  std::string operator()(live::SaveMap) const { return "save map"; }
  std::string operator()(live::Quit) const { return "quit"; }
};

}  // namespace

std::string to_string(const LiveCommand& command) { return std::visit(Tell{}, command); }

Result<LiveCommand> parse_live_command(std::string_view text) {
  for (const LiveCommand& plain :
       {LiveCommand(live::Pause{}), LiveCommand(live::Resume{}), LiveCommand(live::Step{}),
        LiveCommand(live::Reset{}), LiveCommand(live::Quit{}), LiveCommand(live::SaveMap{}),
        LiveCommand(live::SetLocalizationOnly{true}),
        LiveCommand(live::SetLocalizationOnly{false})}) {
    if (text == to_string(plain)) return plain;
  }
  if (text.starts_with(kVariant)) {
    const auto variant = parse_choice<Variant>(text.substr(kVariant.size()));
    if (variant) return LiveCommand(live::SetVariant{*variant});
  }
  return Error{
      fmt::format("command '{}': must be pause, resume, step, reset, save map, quit, localize "
                  "on|off or variant "
                  "off|box|person|full|evidence",
                  on_one_line(text))};
}

std::optional<LiveCommand> LiveControl::next_command(int wait_ms) {
  return wait_ms > 0 ? commands_.pop_within(std::chrono::milliseconds(wait_ms))
                     : commands_.try_pop();
}

void LiveControl::close(LiveEnd end) {
  commands_.close();
  end_.set(std::make_shared<const LiveEnd>(end));
}

}  // namespace ydd
