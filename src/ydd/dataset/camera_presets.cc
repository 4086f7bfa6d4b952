// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/camera_presets.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace ydd {
namespace {

/// Calibrations published with the TUM RGB-D benchmark and the Bonn RGB-D Dynamic dataset; TUM's
/// depth images already carry the correction of their scale, so all five share 5000 counts a metre.
std::vector<Camera> make_presets() {
  Camera fr1{.name = "tum_fr1", .fx_px = 517.306408, .fy_px = 516.469215};
  fr1.cx_px = 318.643040, fr1.cy_px = 255.313989;
  fr1.k1 = 0.262383, fr1.k2 = -0.953104, fr1.k3 = 1.163314;
  fr1.p1 = -0.005358, fr1.p2 = 0.002628;

  Camera fr2{.name = "tum_fr2", .fx_px = 520.908620, .fy_px = 521.007327};
  fr2.cx_px = 325.141442, fr2.cy_px = 249.701764;
  fr2.k1 = 0.231222, fr2.k2 = -0.784899, fr2.k3 = 0.917205;
  fr2.p1 = -0.003257, fr2.p2 = -0.000105;

  Camera fr3{.name = "tum_fr3", .fx_px = 535.4, .fy_px = 539.2, .cx_px = 320.1, .cy_px = 247.6};

  Camera bonn{.name = "bonn", .fx_px = 542.822841, .fy_px = 542.576870};
  bonn.cx_px = 315.593520, bonn.cy_px = 237.756098;
  bonn.k1 = 0.039903, bonn.k2 = -0.099343;
  bonn.p1 = -0.000730, bonn.p2 = -0.000144;

  Camera office = fr3;
  office.name = "office";
  return {fr1, fr2, fr3, bonn, office};
}

/// Name of the preset, or nothing. Dataset names come first: "freiburg3_walking_xyz" is fr3.
std::string preset_name_of(const std::string& folder) {
  const auto contains = [&](std::string_view part) { return folder.find(part) != folder.npos; };
  for (const char* const number : {"1", "2", "3"}) {
    const std::string n = number;
    if (contains("freiburg" + n) || contains("fr" + n)) return "tum_fr" + n;
  }
  if (contains("bonn")) return "bonn";
  // ICL-NUIM's "office_room_traj0" is another camera.
  if (contains("_traj")) return "";
  for (const char* const prefix : {"crowd_", "office_", "walking_"}) {
    if (folder.starts_with(prefix)) return "office";
  }
  return contains("room_loop") ? "office" : "";
}

}  // namespace

const std::vector<Camera>& camera_presets() {
  static const std::vector<Camera> presets = make_presets();
  return presets;
}

std::optional<Camera> camera_preset(std::string_view name) {
  const auto& presets = camera_presets();
  const auto found = std::find_if(presets.begin(), presets.end(),
                                  [&](const Camera& camera) { return camera.name == name; });
  return found == presets.end() ? std::nullopt : std::optional(*found);
}

std::optional<Camera> camera_preset_of_folder(std::string_view folder_name) {
  std::string lower(folder_name);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return camera_preset(preset_name_of(lower));
}

}  // namespace ydd
