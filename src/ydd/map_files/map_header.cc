// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_header.h"

#include <sys/stat.h>

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

Header read_header(const fs::path& file) {
  if (!fs::exists(file)) throw Fault("there is no such file");
  if (!fs::is_regular_file(file)) throw Fault("is not a file");  // a pipe would wait for ever
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Fault("cannot be opened for reading");
  Header header{};
  stream.read(header.data(), header.size());
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  const auto got = static_cast<std::size_t>(stream.gcount());
  if (got == 0) throw Fault("is empty, not a map file");
  if (std::string_view(header.data(), got).substr(0, 16) != kMagic.substr(0, got)) {
    throw Fault("is not a map file of ydd-slam");
  }
  if (got < kHeaderSize) throw Fault("is cut short");
  return header;
}

fs::path journal_of(const fs::path& file) { return file.string() + "-journal"; }

bool has_journal(const fs::path& file) {
  std::error_code ignored;
  const auto size = fs::file_size(journal_of(file), ignored);
  return !ignored && size > 0;
}

}  // namespace

void check_header(const fs::path& file) {
  const Header header = read_header(file);
  if (big_endian(header, 68, 4) != kApplicationId) {
    throw Fault("is an SQLite database of another program, not a map file of ydd-slam");
  }
  const std::uint32_t version = big_endian(header, 60, 4);
  if (version > kVersion) {
    throw Fault(
        fmt::format("was written by a newer ydd-slam (format {}; this one reads {}); use that one",
                    version, kVersion));
  }
  // A log beside the file would be made by reading it already; no map was ever written that way.
  if (header[18] != 1 || header[19] != 1) throw Fault("is damaged (kept with a log beside it)");
  const std::uint32_t page_size = big_endian(header, 16, 2);
  const std::uintmax_t pages = big_endian(header, 28, 4);
  const std::uintmax_t wanted = pages * (page_size == 1 ? 65536 : page_size);
  if (const std::uintmax_t size = fs::file_size(file); size < wanted && !has_journal(file)) {
    throw Fault(fmt::format("is cut short: {} bytes of {}", size, wanted));
  }
}

void recover(const fs::path& file) {
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
  Database(file, Database::Mode::write).number("SELECT count(*) FROM sqlite_master");
}

}  // namespace ydd::map_format
