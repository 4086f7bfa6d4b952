// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/source.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/log.h"
#include "ydd/sources/layout.h"

namespace ydd {
namespace sources {

bool has(const std::filesystem::path& folder, const char* name) {
  std::error_code failure;
  return std::filesystem::exists(folder / name, failure);
}

}  // namespace sources

namespace {

namespace fs = std::filesystem;
using sources::Layout;

/// The first that recognises a path opens it: those that say most of themselves come first.
const std::vector<Layout>& layouts() {
  static const std::vector<Layout> all = {
      sources::icl_layout(),          sources::tum_layout(),     sources::openloris_layout(),
      sources::seven_scenes_layout(), sources::scannet_layout(), sources::open3d_layout(),
      sources::realsense_layout(),    sources::sens_layout(),    sources::bag_layout(),
      sources::openni2_layout()};
  return all;
}

Result<Layout> named_layout(const std::string& name) {
  for (const Layout& layout : layouts()) {
    if (layout.name == name) return layout;
  }
  return Error{fmt::format("sequence.source (--source): '{}' is no source; known are {}", name,
                           fmt::join(source_names(), ", "))};
}

std::string nothing_at(const fs::path& path) {
  return fmt::format("{}: no such file or folder", path.string());
}

Result<Layout> layout_of(const fs::path& path, const SequenceOptions& options) {
  if (!options.source.empty()) return named_layout(options.source);
  for (const Layout& layout : layouts()) {
    if (layout.recognises(path)) return layout;
  }
  std::error_code failure;
  if (!fs::exists(path, failure)) return Error{nothing_at(path)};
  // Lists of pairs can stand alone.
  if (!options.associations.empty()) return sources::tum_layout();
  const char* const lacks = fs::is_directory(path) ? "has no rgb.txt, and " : "";
  return Error{fmt::format(
      "{}: {}is no recording that is known ({}); 'ydd-slam run --help' tells how they look",
      path.string(), lacks, fmt::join(source_names(), ", "))};
}

}  // namespace

std::vector<std::string> source_names() {
  std::vector<std::string> names;
  for (const Layout& layout : layouts()) names.emplace_back(layout.name);
  std::sort(names.begin(), names.end());
  return names;
}

std::string source_table() {
  std::string table;
  for (const Layout& layout : layouts()) {
    table += fmt::format("  {:<12} {}\n", layout.name, layout.what);
  }
  return table;
}

Result<Recording> open_recording(const fs::path& path, const SequenceOptions& options) {
  const Result<Layout> layout = layout_of(path, options);
  if (!layout) return layout.error();
  std::error_code failure;
  if (!layout->is_camera && !fs::exists(path, failure)) return Error{nothing_at(path)};
  Result<Recording> recording = layout->open(path, options);
  if (!recording) return recording;
  recording->place = path;
  recording->source = layout->name;
  if (recording->source != "tum") log::info("{}: source '{}'", path.string(), layout->name);
  return recording;
}

Result<Sequence> open_sequence(const fs::path& path, const SequenceOptions& options) {
  Result<Recording> recording = open_recording(path, options);
  if (!recording) return recording.error();
  if (recording->live) {
    return Error{fmt::format(
        "{}: is a camera, which only 'run' looks through; 'run {} --record FILE' makes a recording "
        "of it",
        path.string(), path.string())};
  }
  return Sequence::of(*std::move(recording), options);
}

}  // namespace ydd
