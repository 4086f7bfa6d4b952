// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_key.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace ydd {
namespace {

constexpr std::size_t kLargestKey = 4096;
constexpr std::size_t kHexDigits = 64;
constexpr const char* kKeyVariable = "YDD_MAP_KEY_FILE";

/// One byte more than a key may have, so that a larger one is seen; wiped in the end.
struct KeyBuffer {
  std::array<char, kLargestKey + 1> bytes{};
  std::size_t size = 0;

  KeyBuffer() = default;
  KeyBuffer(const KeyBuffer&) = delete;
  KeyBuffer& operator=(const KeyBuffer&) = delete;
  ~KeyBuffer() { ::explicit_bzero(bytes.data(), bytes.size()); }
};

bool is_white(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_hex(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

std::string_view without_white_ends(std::string_view text) {
  while (!text.empty() && is_white(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_white(text.back())) text.remove_suffix(1);
  return text;
}

/// Whether all of it was read; errno says why not.
bool read_all(int descriptor, KeyBuffer& into) {
  while (into.size < into.bytes.size()) {
    const ssize_t got =
        ::read(descriptor, into.bytes.data() + into.size, into.bytes.size() - into.size);
    if (got == 0) return true;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    into.size += static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace

/// The bytes as SQLCipher takes them: x'HEX' for a key, else the phrase.
struct MapKey::Secret {
  explicit Secret(std::string_view content)
      : raw(content.size() == kHexDigits && std::ranges::all_of(content, is_hex)) {
    const auto add = [this](std::string_view text) {
      std::ranges::copy(text, bytes.begin() + static_cast<std::ptrdiff_t>(size));
      size += text.size();
    };
    if (raw) add("x'");
    add(content);
    if (raw) add("'");
  }
  Secret(const Secret&) = delete;
  Secret& operator=(const Secret&) = delete;
  ~Secret() { ::explicit_bzero(bytes.data(), bytes.size()); }

  bool raw;
  std::array<char, kLargestKey> bytes{};
  std::size_t size = 0;
};

Result<MapKey> MapKey::of(std::string_view content) {
  const std::string_view trimmed = without_white_ends(content);
  if (trimmed.empty()) return Error{"is empty, not a key"};
  if (trimmed.size() > kLargestKey) {
    return Error{fmt::format("is larger than a key may be ({} bytes)", kLargestKey)};
  }
  MapKey key;
  key.secret_ = std::make_shared<const Secret>(trimmed);
  return key;
}

Result<MapKey> MapKey::read(const std::filesystem::path& file) {
  const auto failure = [&](std::string_view why) {
    return Error{fmt::format("{}: {}", file.string(), why)};
  };
  const auto system_failure = [&] {
    return failure("the key cannot be read: " + std::generic_category().message(errno));
  };
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return system_failure();
  struct Closing {
    int descriptor;
    ~Closing() { ::close(descriptor); }
  } const closing{descriptor};
  struct stat about = {};
  if (::fstat(descriptor, &about) != 0) return system_failure();
  if (S_ISREG(about.st_mode) && (about.st_mode & S_IRWXO) != 0) {
    return failure("everybody may read this key: chmod 600 it (and change it if somebody has)");
  }
  KeyBuffer buffer;
  if (!read_all(descriptor, buffer)) return system_failure();
  Result<MapKey> key = of({buffer.bytes.data(), buffer.size});
  return key ? key : failure(key.error().message);
}

Result<MapKey> MapKey::find(const std::filesystem::path& file) {
  if (!file.empty()) return read(file);
  const char* const named = std::getenv(kKeyVariable);
  if (named == nullptr || *named == '\0') return MapKey();
  Result<MapKey> key = read(named);
  return key ? key : Error{fmt::format("{} ({})", key.error().message, kKeyVariable)};
}

bool MapKey::operator==(const MapKey& other) const { return bytes() == other.bytes(); }

std::string_view MapKey::bytes() const {
  return secret_ ? std::string_view(secret_->bytes.data(), secret_->size) : std::string_view();
}

bool MapKey::is_raw() const { return secret_ && secret_->raw; }

}  // namespace ydd
