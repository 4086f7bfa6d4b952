// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_header.h"
#include "ydd/map_files/map_rows.h"

namespace ydd {
namespace {

using map_format::Database;
using map_format::Row;
using map_format::TableShape;

constexpr std::size_t kMostFaults = 100;  // of one kind

/// Runs one part of the look; what it throws is a fault.
template <class Part>
bool look(std::vector<std::string>& faults, const std::string& where, Part&& part) {
  try {
    part();
    return true;
  } catch (const std::exception& fault) {
    faults.push_back(where + fault.what());
    return false;
  }
}

void check_pages(Database& database, std::vector<std::string>& faults) {
  look(faults, "", [&] {
    const std::string sql = fmt::format("PRAGMA integrity_check({})", kMostFaults);
    for (std::string line : database.texts(sql)) {
      std::replace(line.begin(), line.end(), '\n', ' ');
      if (line != "ok") faults.push_back(std::move(line));
    }
  });
}

/// The sum of the checksums that the rows of a table should have.
std::uint64_t check_rows(Database& database, const TableShape& table,
                         std::vector<std::string>& faults) {
  std::uint64_t digest = 0;
  std::size_t wrong = 0;
  look(faults, fmt::format("table {}: ", table.name), [&] {
    database.for_each_unchecked(table, [&](const Row& row, std::uint64_t stored) {
      digest += stored;
      if (map_format::checksum_of(table, row) == stored || ++wrong > kMostFaults) return;
      faults.push_back(
          fmt::format("table {}, row {}: checksum does not match", table.name, row.key));
    });
  });
  if (wrong > kMostFaults) {
    faults.push_back(
        fmt::format("table {}: {} more rows like that", table.name, wrong - kMostFaults));
  }
  return digest;
}

void check_content(Database& database, std::int64_t version, std::vector<std::string>& faults) {
  std::uint64_t digest = 0;
  for (const TableShape* const table : map_format::content_of(version)) {
    digest += check_rows(database, *table, faults);
  }
  const bool sound = faults.empty();
  check_rows(database, map_format::kAtlas, faults);
  constexpr std::size_t kDigest = 13;  // column of kAtlas
  look(faults, "table atlas: ", [&] {
    database.for_each_unchecked(map_format::kAtlas, [&](const Row& row, std::uint64_t) {
      if (sound && static_cast<std::uint64_t>(row.integer(kDigest)) != digest) {
        faults.emplace_back("rows of it are missing, or not of one save");
      }
    });
  });
}

}  // namespace

MapCheck check_map(const std::filesystem::path& file, const MapKey& key) {
  MapCheck check;
  look(check.faults, "", [&] {
    map_format::check_header(file, key);
    map_format::recover(file, key);
    Database database(file, Database::Mode::read, key);
    database.run("BEGIN");
    const std::int64_t version = database.number("PRAGMA user_version");
    database.expect_tables(map_format::tables_of(version));
    check_pages(database, check.faults);
    check_content(database, version, check.faults);
  });
  if (!check.faults.empty()) return check;
  look(check.faults, "", [&] {
    const Atlas atlas = map_format::read_rows(file, key).atlas;
    check.keyframes = atlas.keyframes().size();
    check.points = atlas.points().size();
    std::set<MapId> maps;
    atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { maps.insert(k.map); });
    check.maps = maps.size();
  });
  return check;
}

}  // namespace ydd
