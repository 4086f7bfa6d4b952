// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "ydd/base/result.h"

namespace ydd {

/// What encrypts map files (docs/privacy.md, docs/adr/0014-encrypted-maps.md); an empty one: they
/// are plain.
///
/// Copies share one secret, which is wiped when the last of them goes. Nothing prints it: no text
/// can be had of it, and no error or log line holds any of it. Thread: any.
class MapKey {
 public:
  MapKey() = default;

  /// The key in a file: 64 hexadecimal digits are the key itself, 256 bits; anything else is a pass
  /// phrase, of which SQLCipher makes one. White space at both ends is no part of it. A pipe will
  /// do (`--map-key <(...)`). Failure: names the file: it cannot be read, is empty, larger than 4
  /// kB, or a regular file that everybody may read.
  static Result<MapKey> read(const std::filesystem::path& file);

  /// That of `file`; if that is empty, of the file that the environment's YDD_MAP_KEY_FILE names;
  /// if there is none either, the empty key. Failure: as `read`.
  static Result<MapKey> find(const std::filesystem::path& file);

  /// The same from memory that is the caller's to wipe. Failure: it is empty or larger than 4 kB.
  static Result<MapKey> of(std::string_view content);

  explicit operator bool() const { return secret_ != nullptr; }
  bool operator==(const MapKey& other) const;

  /// As sqlite3_key takes it; empty without a key. For who opens databases.
  std::string_view bytes() const;
  /// Whether it is the key itself, not a phrase to make one of.
  bool is_raw() const;

 private:
  struct Secret;
  std::shared_ptr<const Secret> secret_;
};

/// Empty if this program can encrypt here; else one line that says what is missing.
std::string_view why_no_encryption();

}  // namespace ydd
