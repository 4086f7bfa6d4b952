// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/camera_note.h"

#include <fmt/format.h>

namespace ydd {

std::map<std::string, std::string> camera_note(const Camera& camera) {
  Camera copy = camera;  // a table can also set what it describes
  OptionTable table;
  copy.describe(table);
  std::map<std::string, std::string> out;
  for (const Option& option : table.options()) {
    out[option.key] = option.key == "name" ? camera.name : format_value(option);
  }
  return out;
}

Result<Camera> camera_of_note(const std::map<std::string, std::string>& note) {
  Camera camera;
  OptionTable table;
  camera.describe(table);
  for (const auto& [key, value] : note) {
    if (auto r = table.set(key, value, kCameraNote); !r) return r.error();
  }
  if (auto r = check_camera(camera); !r) {
    return Error{fmt::format("{}: {}", kCameraNote, r.error().message)};
  }
  return camera;
}

}  // namespace ydd
