// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_header.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "ydd/base/file_lock.h"
#include "ydd/map_files/database.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_schema.h"

namespace ydd::map_format {
namespace {

namespace fs = std::filesystem;

// SQLite file format, section 1.3: the database header.
constexpr std::size_t kHeaderSize = 100;
using Header = std::array<char, kHeaderSize>;

std::uint32_t big_endian(const Header& header, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value = value << 8U | static_cast<std::uint8_t>(header[at + i]);
  }
  return value;
}

/// The first bytes of a file.
std::string start_of(const fs::path& file, std::size_t most) {
  if (!fs::exists(file)) throw Fault("there is no such file");
  if (!fs::is_regular_file(file)) throw Fault("is not a file");  // a pipe would wait for ever
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Fault("cannot be opened for reading");
  std::string start(most, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(most));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  if (start.empty()) throw Fault("is empty, not a map file");
  return start;
}

bool has_magic(std::string_view start) {
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  return start.substr(0, 16) == kMagic.substr(0, start.size());
}

/// Whether these bytes may be encrypted: no text, no picture with its header, no zeros.
bool looks_encrypted(std::string_view start) {
  constexpr int kMostOfOne = 64;  // of 4096 random bytes each comes 16 times
  constexpr int kLeastDifferent = 240;
  if (start.size() < kCipherPage) return false;
  std::array<int, 256> counts{};
  for (const char c : start) ++counts[static_cast<std::uint8_t>(c)];
  return std::ranges::count_if(counts, [](int n) { return n > 0; }) >= kLeastDifferent &&
         *std::ranges::max_element(counts) <= kMostOfOne;
}

/// What can be told of a file that is not one of plain SQLite.
void check_encrypted(std::string_view start, const MapKey& key) {
  if (!looks_encrypted(start)) throw Fault("is not a map file of ydd-slam");
  if (!key) {
    throw Refused(
        "is encrypted, or no map file of ydd-slam; --map-key FILE (or the environment's "
        "YDD_MAP_KEY_FILE) names the file with its key");
  }
  (void)cipher_sqlite();
}

Header read_header(std::string_view start) {
  if (start.size() < kHeaderSize) throw Fault("is cut short");
  Header header{};
  std::ranges::copy(start.substr(0, kHeaderSize), header.begin());
  return header;
}

fs::path journal_of(const fs::path& file) { return file.string() + "-journal"; }

bool has_journal(const fs::path& file) {
  std::error_code ignored;
  const auto size = fs::file_size(journal_of(file), ignored);
  return !ignored && size > 0;
}

}  // namespace

std::string newer_version(std::int64_t version) {
  return fmt::format("was written by a newer ydd-slam (format {}; this one reads {}); use that one",
                     version, kVersion);
}

void check_header(const fs::path& file, const MapKey& key) {
  const std::string start = start_of(file, kCipherPage);
  if (!has_magic(start)) return check_encrypted(start, key);
  const Header header = read_header(start);
  if (big_endian(header, 68, 4) != kApplicationId) {
    throw Fault("is an SQLite database of another program, not a map file of ydd-slam");
  }
  const std::uint32_t version = big_endian(header, 60, 4);
  if (version > kVersion) throw Fault(newer_version(version));
  // A log beside the file would be made by reading it already; no map was ever written that way.
  if (header[18] != 1 || header[19] != 1) throw Fault("is damaged (kept with a log beside it)");
  const std::uint32_t page_size = big_endian(header, 16, 2);
  const std::uintmax_t pages = big_endian(header, 28, 4);
  const std::uintmax_t wanted = pages * (page_size == 1 ? 65536 : page_size);
  if (const std::uintmax_t size = fs::file_size(file); size < wanted && !has_journal(file)) {
    throw Fault(fmt::format("is cut short: {} bytes of {}", size, wanted));
  }
  if (key) {
    throw Refused(
        "is not encrypted, and there is a map key; leave out the key, or encrypt the file with "
        "'ydd-slam map encrypt'");
  }
}

void recover(const fs::path& file, const MapKey& key) {
  if (!has_journal(file)) return;
  struct stat journal = {};
  struct stat map = {};
  if (::lstat(journal_of(file).c_str(), &journal) != 0 || ::stat(file.c_str(), &map) != 0) return;
  if (!S_ISREG(journal.st_mode) || journal.st_uid != map.st_uid) {
    throw Fault(fmt::format("what lies at {} was not left by who saved the map; take it away",
                            journal_of(file).string()));
  }
  const Result<FileLock> lock = FileLock::take(file, false);
  if (!lock) return;  // somebody is saving: readers wait for them, nothing is to be mended
  // The first read rolls back, if that journal is one of a save that was killed.
  Database(file, Database::Mode::write, key).number("SELECT count(*) FROM sqlite_master");
}

}  // namespace ydd::map_format
