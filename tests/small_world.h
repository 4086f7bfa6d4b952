// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command_line.h"

/// Small simulated sequences for the end-to-end tests, rendered once for all of them.
namespace ydd::e2e {

/// Frames of `room` and `busy`: two seconds of the path, less for sanitized programs.
inline constexpr int kFrames = kSanitized ? 12 : 60;

/// The folder of the sequence `name`, rendered with `options` when it is not there yet. It lies
/// beside the tests and is rendered anew when the binary has changed. Read only.
inline fs::path small_world(const std::string& name, const std::vector<std::string>& options) {
  const fs::path binary = YDD_BINARY;
  const auto built = fs::last_write_time(binary).time_since_epoch();
  const fs::path root = binary.parent_path() / "e2e-sequences";
  const fs::path age = root / fmt::format("{}", std::chrono::nanoseconds(built).count());
  fs::path folder = age / name;
  if (fs::exists(folder)) return folder;
  fs::create_directories(age);
  for (const fs::directory_entry& other : fs::directory_iterator(root)) {
    std::error_code ignored;
    if (other.path() != age) fs::remove_all(other.path(), ignored);
  }
  std::vector<std::string> arguments = {"simulate", folder.string(), "--quiet"};
  for (const char* const size : {"--set", "width=320", "--set", "height=240"}) {
    arguments.emplace_back(size);
  }
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome made = ydd_slam(arguments);
  // Another test may have been faster: the folder appears whole or not at all.
  if (made.exit_code != 0 && !fs::exists(folder)) throw std::runtime_error(made.err);
  return folder;
}

/// An empty room, depth as from a Kinect.
inline fs::path room() {
  return small_world("room", {"--frames", fmt::format("{}", kFrames), "--depth", "kinect"});
}

/// The same path with people who fill half the picture.
inline fs::path busy_room() {
  return small_world("busy",
                     {"--frames", fmt::format("{}", kFrames), "--depth", "kinect", "--busy"});
}

/// A few frames, for what does not depend on the picture.
inline fs::path few_frames() { return small_world("few", {"--frames", "6"}); }

/// A copy of a sequence that a test may damage.
inline fs::path copy_of(const fs::path& sequence, const fs::path& to) {
  fs::copy(sequence, to, fs::copy_options::recursive);
  return to;
}

}  // namespace ydd::e2e
