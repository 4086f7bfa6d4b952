// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ydd/base/result.h"

namespace ydd {

/// A folder that is being filled beside the one that it will be: it gets that name by `place`, or
/// goes with the object. Two programs may fill one for the same name.
class FreshFolder {
 public:
  /// Nothing is made yet; what an earlier process of this number left is removed.
  explicit FreshFolder(const std::filesystem::path& target);
  ~FreshFolder();
  FreshFolder(const FreshFolder&) = delete;
  FreshFolder& operator=(const FreshFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }  ///< Where it is while it is filled.
  /// Renames it; the failure names both.
  Result<void> place() const;

 private:
  std::filesystem::path target_, path_;
};

}  // namespace ydd
