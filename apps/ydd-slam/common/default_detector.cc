// SPDX-License-Identifier: Apache-2.0
#include "common/default_detector.h"

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

namespace ydd::app {

namespace fs = std::filesystem;
namespace {

/// A variable that is set to nothing names nothing.
const char* named_by_environment() {
  const char* const named = std::getenv("YDD_DETECTOR");
  return named != nullptr && *named != '\0' ? named : nullptr;
}

}  // namespace

Result<std::string> default_detector() {
  if (const char* const named = named_by_environment()) return std::string(named);
  std::error_code failure;
  const fs::path above = fs::read_symlink("/proc/self/exe", failure).parent_path().parent_path();
  const fs::path file = fs::path("configs") / "detector" / "ydd.yaml";
  const fs::path installed = above / "share" / "ydd-slam" / file;
  const fs::path in_clone = above / file;
  for (const fs::path& place : {installed, in_clone}) {
    if (fs::is_regular_file(place, failure)) return place.string();
  }
  return Error{
      fmt::format("there is no detector file {} or {}: name one with --detector FILE or in the "
                  "environment variable YDD_DETECTOR, or run with --detector none",
                  installed.string(), in_clone.string())};
}

std::string default_detector_origin() {
  return named_by_environment() != nullptr
             ? "this detector is named by the environment variable YDD_DETECTOR"
             : "this is the detector of a run that names none; --detector FILE names another, "
               "--detector none runs without";
}

}  // namespace ydd::app
