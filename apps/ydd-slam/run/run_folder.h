// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "ydd/base/result.h"

namespace ydd::app {

/// Folders that go again, as long as they are empty, unless what they were made for came true.
class NewFolders {
 public:
  NewFolders() = default;
  ~NewFolders();
  NewFolders(NewFolders&& other) noexcept : made_(std::exchange(other.made_, {})) {}
  NewFolders& operator=(NewFolders&& other) noexcept {
    std::swap(made_, other.made_);
    return *this;
  }

  /// Makes `folder` and those above it. One that is there already is fine, and is not ours.
  Result<void> make(const std::filesystem::path& folder);
  /// They stay.
  void keep() { made_.clear(); }

 private:
  std::vector<std::filesystem::path> made_;  ///< outermost first
};

/// The folder of a run.
class RunFolder {
 public:
  /// Makes `out`, or runs/<sequence>-<time>, which is then new, when `out` is empty.
  static Result<RunFolder> make(const std::string& out, const std::string& sequence);

  const std::filesystem::path& path() const { return path_; }
  /// The run has finished: the folder stays, and runs/latest points at it unless it was named.
  void keep();

 private:
  NewFolders new_folders_;
  std::filesystem::path path_;
  bool named_ = false;
};

}  // namespace ydd::app
