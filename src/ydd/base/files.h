// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "ydd/base/result.h"

namespace ydd {

/// Writes `content` to a temporary file beside `file`, flushes it to disk and renames it: readers
/// see the old file or the whole new one, which keeps the old one's mode. Where `file` is a link,
/// what it leads to is replaced and the link stays. What is no regular file (/dev/stdout, a pipe)
/// is written to, never replaced; a folder, a socket or a disk is refused.
Result<void> write_file_atomically(const std::filesystem::path& file, std::string_view content);

/// The whole file, if it is a regular one (a pipe would wait for ever) of at most `max_bytes`.
Result<std::string> read_file_bounded(const std::filesystem::path& file, std::uintmax_t max_bytes);

/// The same, up to 2 GiB.
Result<std::string> read_file(const std::filesystem::path& file);

/// Where writing to `file` ends up: follows links, also those that lead to nothing yet.
std::filesystem::path follow_links(const std::filesystem::path& file);

/// An empty file of an unpredictable name beside `target`, made for writers that want a name. It
/// replaces `target` by `place`, or goes with the object.
class FreshFile {
 public:
  /// `ending`: of the name, such as ".tmp". Failure: names `target`.
  static Result<FreshFile> make(const std::filesystem::path& target, std::string_view ending);

  FreshFile(FreshFile&& other) noexcept;
  FreshFile& operator=(FreshFile&& other) noexcept;
  FreshFile(const FreshFile&) = delete;
  FreshFile& operator=(const FreshFile&) = delete;
  ~FreshFile();

  const std::filesystem::path& path() const { return path_; }  ///< Where it is while it is written.
  /// Of the open file, for whoever writes to it by other means; stays this object's.
  int descriptor() const { return descriptor_; }
  /// Writes at its end.
  Result<void> append(std::string_view bytes);
  /// Flushes to disk and renames.
  Result<void> place();

 private:
  FreshFile(std::filesystem::path target, std::filesystem::path path, int descriptor);
  Result<void> take_over_mode();

  std::filesystem::path target_, path_;
  int descriptor_ = -1;
};

}  // namespace ydd
