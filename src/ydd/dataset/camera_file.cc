// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/camera_file.h"

#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/log.h"
#include "ydd/dataset/camera_forms.h"
#include "ydd/dataset/camera_presets.h"

namespace ydd {
namespace {

/// Sets the option `value.key` of `ours`; a failure calls it as the file does.
Result<void> set_value(const OptionTable& ours, const GivenValue& value) {
  for (const Option& option : ours.options()) {
    if (option.key != value.key) continue;
    OptionTable theirs;
    if (auto* const* i = std::get_if<int*>(&option.target)) {
      theirs.add(value.theirs, **i, option.range, option.unit, option.sentence);
    } else if (auto* const* d = std::get_if<double*>(&option.target)) {
      theirs.add(value.theirs, **d, option.range, option.unit, option.sentence);
    } else {
      theirs.add(value.theirs, *std::get<std::string*>(option.target), {}, option.sentence);
    }
    // A width of "640.0" is a whole number.
    std::string text = value.text;
    if (text.ends_with(".0") && std::holds_alternative<int*>(option.target)) {
      text.resize(text.size() - 2);
    }
    auto set = theirs.set(value.theirs, text, value.source);
    if (set || value.key != "depth_scale") return set;
    return Error{set.error().message +
                 ", the depth image's value of one metre (1000: millimetres)"};
  }
  return Error{
      fmt::format("{}: unknown key '{}'; a camera has width, height, fx, fy, cx, cy, k1, "
                  "k2, p1, p2, k3, depth_scale, min_depth, max_depth, fps, baseline, name",
                  value.source, value.theirs)};
}

}  // namespace

Result<Camera> load_camera(const std::filesystem::path& file, std::optional<double> depth_scale) {
  const Result<GivenCamera> given = read_camera_form(file, depth_scale);
  if (!given) return given.error();
  Camera camera;
  camera.name = file.stem().string();
  OptionTable table;
  camera.describe(table);
  bool has_baseline = false;
  for (const GivenValue& value : given->values) {
    has_baseline = has_baseline || value.key == "baseline";
    if (auto r = set_value(table, value); !r) return r.error();
  }
  double bf_px_m = 0;
  OptionTable bf;
  for (const GivenValue& value : given->bf_px_m) {
    bf.add(value.theirs, bf_px_m, {0.1, 1e6}, "px m", "");
    if (auto r = bf.set(value.theirs, value.text, value.source); !r) return r.error();
    if (!has_baseline) camera.baseline_m = bf_px_m / camera.fx_px;
  }
  if (auto checked = check_camera(camera); !checked) {
    return Error{fmt::format("{}: {}", file.string(), checked.error().message)};
  }
  return camera;
}

Result<Camera> find_camera(const std::filesystem::path& sequence_dir, const std::string& camera,
                           const std::optional<Result<Camera>>& own_camera) {
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
  if (own_camera) return *own_camera;
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

Result<Camera> find_camera(const Recording& recording, const std::string& camera) {
  Result<Camera> found = find_camera(recording.place, camera, recording.camera);
  if (!found || !recording.depth_scale || *recording.depth_scale == found->depth_scale) {
    return found;
  }
  const bool is_preset = !camera.empty() && !std::filesystem::exists(camera);
  if (is_preset) {  // that is about another format of the same camera
    log::info("{}: depth counts {:g} to the metre, as in every recording of '{}'",
              recording.place.string(), *recording.depth_scale, recording.source);
    found->depth_scale = *recording.depth_scale;
  } else {
    log::warning(
        "{}: depth of a recording of '{}' counts {:g} to the metre, but the depth_scale of camera "
        "'{}' is {:g}, which is used",
        recording.place.string(), recording.source, *recording.depth_scale, found->name,
        found->depth_scale);
  }
  return found;
}

}  // namespace ydd
