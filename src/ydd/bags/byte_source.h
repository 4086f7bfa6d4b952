// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "ydd/base/result.h"

/// Bytes by position, for who walks through large files.
namespace ydd::bags {

/// No message of a picture and no chunk is larger.
inline constexpr std::uint64_t kLargestPiece = std::uint64_t{256} << 20U;

/// A regular file, read at any place by any thread.
class BagFile {
 public:
  static Result<BagFile> open(const std::filesystem::path& file);
  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }
  /// Nothing when they are not all there, or cannot be read.
  std::optional<std::string> read(std::uint64_t offset, std::uint64_t size) const;

 private:
  std::filesystem::path path_;
  std::shared_ptr<const int> descriptor_;
  std::uint64_t size_ = 0;
};

/// What records are read from, one after the other: a file through a window, or text.
class ByteSource {
 public:
  explicit ByteSource(const BagFile& file) : file_(&file) {}
  explicit ByteSource(std::string_view text) : text_(text) {}

  std::uint64_t size() const { return file_ ? file_->size() : text_.size(); }
  /// Valid until the next call; nothing when they are not all there.
  std::optional<std::string_view> at(std::uint64_t offset, std::uint64_t size);

 private:
  const BagFile* file_ = nullptr;
  std::string_view text_;
  std::string window_;
  std::uint64_t window_begin_ = 0;
};

/// Little endian, of at most eight bytes.
std::uint64_t little_endian(std::string_view bytes);

/// `kind`: "bz2", "lz4" (frames) or "zstd". Nothing but `size` bytes will do. `size` is at most
/// kLargestPiece. The error does not name the file.
Result<std::string> decompressed(std::string_view kind, std::string_view bytes, std::uint64_t size);

/// zstd frames that tell their own size; for whole messages.
bool is_zstd(std::string_view bytes);
Result<std::string> decompressed_zstd(std::string_view bytes);

}  // namespace ydd::bags
