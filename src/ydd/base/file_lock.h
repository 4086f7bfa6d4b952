// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ydd/base/result.h"

namespace ydd {

/// An exclusive claim on a file (flock) against other processes and other claims of this one; ends
/// with the object or the process. It is the file's, not its name's: it goes along when the file is
/// renamed. Where the file system knows no locks, every claim succeeds.
class FileLock {
 public:
  /// Opens the file (made empty if it is not there and `create`) and claims it, without waiting.
  static Result<FileLock> take(const std::filesystem::path& file, bool create);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

  /// Whether that name still leads to this file.
  bool is_named(const std::filesystem::path& file) const;
  /// What was written to the file, by whomever, is on the disk when this returns true.
  bool flush() const;

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

/// Makes what was created or renamed in a folder last through a power cut.
bool flush_folder(const std::filesystem::path& folder);

}  // namespace ydd
