// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/result.h"

namespace ydd::app {

/// A folder for what a bench needs meanwhile; it goes with this value.
class ScratchFolder {
 public:
  /// Makes one of a name that nobody can foresee, below TMPDIR or /tmp.
  static Result<ScratchFolder> make() {
    std::error_code failure;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(failure);
    std::string name = (parent / "ydd-slam-XXXXXX").string();
    if (failure || !::mkdtemp(name.data())) {
      return Error{
          fmt::format("no folder for the time of the bench can be made below {}: TMPDIR "
                      "must name a folder that can be written to",
                      failure ? "TMPDIR" : parent.string())};
    }
    return ScratchFolder(name);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ScratchFolder& operator=(ScratchFolder&&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace ydd::app
