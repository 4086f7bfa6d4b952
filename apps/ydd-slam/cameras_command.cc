// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "ydd/base/json_text.h"
#include "ydd/cameras/openni2.h"

namespace ydd::app {
namespace {

using Json = nlohmann::ordered_json;

void print_table(const std::vector<CameraDevice>& cameras) {
  if (cameras.empty()) fmt::print("no camera is plugged in that OpenNI2 has a driver for\n");
  for (const CameraDevice& camera : cameras) {
    fmt::print("openni2:{}  {}\n", camera.uri, camera.name);
    if (!camera.problem.empty()) {
      fmt::print("  cannot be opened: {}\n", camera.problem);
      continue;
    }
    fmt::print("  colour  {}\n  depth   {}{}\n", listed(camera.colour), listed(camera.depth),
               camera.registers ? "" : "  (cannot be laid over colour)");
  }
}

Json modes_json(const std::vector<CameraMode>& modes) {
  Json out = Json::array();
  for (const CameraMode& mode : modes) out.push_back(to_string(mode));
  return out;
}

void print_json(const std::vector<CameraDevice>& cameras) {
  Json out = Json::array();
  for (const CameraDevice& camera : cameras) {
    out.push_back({{"source", "openni2:" + camera.uri},
                   {"name", camera.name},
                   {"colour", modes_json(camera.colour)},
                   {"depth", modes_json(camera.depth)},
                   {"registers", camera.registers},
                   {"problem", camera.problem}});
  }
  fmt::print("{}\n", json_text(out, 2));
}

Result<void> list_cameras(bool json) {
  const Result<std::vector<CameraDevice>> cameras = list_openni2_cameras();
  if (!cameras) return cameras.error();
  json ? print_json(*cameras) : print_table(*cameras);
  return {};
}

}  // namespace

void add_cameras_command(CLI::App& app, Job& job) {
  auto json = std::make_shared<bool>(false);
  auto* command = app.add_subcommand("cameras", "List the cameras that are plugged in, with modes");
  command->add_flag("--json", *json, "As JSON");
  command->footer(
      "Example:\n  ydd-slam cameras && ydd-slam run openni2 --mode 640x480@30 --record walk.mcap");
  command->callback([json, &job] { job = [json] { return list_cameras(*json); }; });
}

}  // namespace ydd::app
