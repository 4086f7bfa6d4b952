// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/camera_file.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_presets.h"

namespace ydd {
namespace {

struct YamlLine {
  std::string key;
  std::string value;
  std::string source;  ///< "file:line"
  bool is_text;        ///< a single value, not a list or map
};

/// Top-level entries. OpenCV's "%YAML:1.0" is no directive of YAML: blanked, which keeps line
/// numbers.
Result<std::vector<YamlLine>> read_lines(const std::filesystem::path& file) {
  Result<std::string> text = read_file(file);
  if (!text) return text.error();
  if (text->starts_with("%YAML:")) text->replace(0, std::min(text->find('\n'), text->size()), "");
  try {
    const YAML::Node root = YAML::Load(*text);
    if (!root.IsMap()) return Error{fmt::format("{}: must hold 'key: value' lines", file.string())};
    std::vector<YamlLine> lines;
    for (const auto& entry : root) {
      const bool is_text = entry.second.IsScalar();
      lines.push_back({entry.first.Scalar(), is_text ? entry.second.Scalar() : "",
                       fmt::format("{}:{}", file.string(), entry.first.Mark().line + 1), is_text});
    }
    return lines;
  } catch (const YAML::Exception& e) {
    return Error{fmt::format("{}:{}: not valid YAML: {}", file.string(), e.mark.line + 1, e.msg)};
  }
}

bool has_key(const std::vector<YamlLine>& lines, std::string_view key) {
  return std::any_of(lines.begin(), lines.end(), [&](const YamlLine& l) { return l.key == key; });
}

Result<void> require_keys(const std::vector<YamlLine>& lines,
                          const std::vector<std::string>& required,
                          const std::filesystem::path& file) {
  for (const std::string& key : required) {
    if (has_key(lines, key)) continue;
    return Error{fmt::format("{}: '{}' is missing; a camera needs {}", file.string(), key,
                             fmt::join(required, ", "))};
  }
  return {};
}

/// Assigns the lines that `table` knows and, if `strict`, refuses the others.
Result<void> assign(OptionTable& table, const std::vector<YamlLine>& lines, bool strict) {
  std::set<std::string> known;
  for (const Option& option : table.options()) known.insert(option.key);
  for (const YamlLine& line : lines) {
    if (!strict && !known.contains(line.key)) continue;
    if (!line.is_text) {
      return Error{fmt::format("{}: '{}' must be a single value", line.source, line.key)};
    }
    if (auto r = table.set(line.key, line.value, line.source); !r) return r;
  }
  return {};
}

Result<Camera> checked(const Camera& camera, const std::filesystem::path& file) {
  if (camera.min_depth_m >= camera.max_depth_m) {
    return Error{fmt::format("{}: min_depth {} m must be less than max_depth {} m", file.string(),
                             camera.min_depth_m, camera.max_depth_m)};
  }
  return camera;
}

Result<Camera> camera_from_own(const std::vector<YamlLine>& lines,
                               const std::filesystem::path& file) {
  if (auto r = require_keys(lines, {"width", "height", "fx", "fy", "cx", "cy"}, file); !r) {
    return r.error();
  }
  Camera camera;
  camera.name = file.stem().string();
  OptionTable table;
  camera.describe(table);
  if (auto r = assign(table, lines, true); !r) return r.error();
  return checked(camera, file);
}

/// Adds the option `ours` of the camera under the key of the other programme, same range.
void add_alias(OptionTable& table, const OptionTable& ours, std::string_view our_key,
               const std::string& their_key) {
  for (const Option& option : ours.options()) {
    if (option.key != our_key) continue;
    if (auto* const* i = std::get_if<int*>(&option.target)) {
      table.add(their_key, **i, option.range, option.unit, option.sentence);
    } else if (auto* const* d = std::get_if<double*>(&option.target)) {
      table.add(their_key, **d, option.range, option.unit, option.sentence);
    }
  }
}

/// The two generations of ORB-SLAM3's settings differ in their keys: "Camera.fx" with "Camera.bf"
/// and "DepthMapFactor", and (File.version 1.0) "Camera1.fx" with "Stereo.b" and
/// "RGBD.DepthMapFactor".
Result<Camera> camera_from_orbslam(const std::vector<YamlLine>& lines, bool is_new,
                                   const std::filesystem::path& file) {
  const std::string prefix = is_new ? "Camera1." : "Camera.";
  const std::string scale_key = is_new ? "RGBD.DepthMapFactor" : "DepthMapFactor";
  if (auto r = require_keys(lines,
                            {prefix + "fx", prefix + "fy", prefix + "cx", prefix + "cy",
                             "Camera.width", "Camera.height", scale_key},
                            file);
      !r) {
    return r.error();
  }
  Camera camera;
  camera.name = file.stem().string();
  std::string model = "PinHole";
  double bf_px_m = 0;
  OptionTable ours;
  camera.describe(ours);
  OptionTable theirs;
  theirs.add("Camera.type", model, {"PinHole", "Rectified"}, "");
  for (const char* const key : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"}) {
    add_alias(theirs, ours, key, prefix + key);
  }
  for (const char* const key : {"width", "height", "fps"}) {
    add_alias(theirs, ours, key, std::string("Camera.") + key);
  }
  add_alias(theirs, ours, "depth_scale", scale_key);
  if (is_new) add_alias(theirs, ours, "baseline", "Stereo.b");
  theirs.add("Camera.bf", bf_px_m, {0.1, 1e6}, "px m", "");
  if (auto r = assign(theirs, lines, false); !r) return r.error();
  if (bf_px_m > 0 && !has_key(lines, "Stereo.b")) camera.baseline_m = bf_px_m / camera.fx_px;
  return checked(camera, file);
}

}  // namespace

Result<Camera> load_camera(const std::filesystem::path& file) {
  const Result<std::vector<YamlLine>> lines = read_lines(file);
  if (!lines) return lines.error();
  if (has_key(*lines, "Camera1.fx")) return camera_from_orbslam(*lines, true, file);
  if (has_key(*lines, "Camera.fx")) return camera_from_orbslam(*lines, false, file);
  return camera_from_own(*lines, file);
}

Result<Camera> find_camera(const std::filesystem::path& sequence_dir, const std::string& camera) {
  std::vector<std::string> names;
  for (const Camera& preset : camera_presets()) names.push_back(preset.name);
  if (!camera.empty()) {
    if (std::filesystem::exists(camera)) return load_camera(camera);
    if (const auto preset = camera_preset(camera)) return *preset;
    return Error{
        fmt::format("{}: no such camera file, nor a preset ({})", camera, fmt::join(names, ", "))};
  }
  if (const auto own = sequence_dir / "camera.yaml"; std::filesystem::exists(own)) {
    return load_camera(own);
  }
  // "data/fr1_xyz/" and "." name their folder only when resolved.
  std::error_code failure;
  const auto resolved = std::filesystem::weakly_canonical(sequence_dir, failure);
  if (const auto preset = camera_preset_of_folder(resolved.filename().string())) {
    log::info("camera: preset {} (by the folder's name)", preset->name);
    return *preset;
  }
  return Error{
      fmt::format("{}: which camera? put a camera.yaml there or give --camera FILE or one "
                  "of the presets {}",
                  sequence_dir.string(), fmt::join(names, ", "))};
}

}  // namespace ydd
