// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <unordered_map>
#include <utility>

#include "ydd/map/atlas.h"
#include "ydd/map_files/map_schema.h"

/// The rows of a map file, and how those that differ from a map get there. Inside the room only.
namespace ydd::map_format {

/// Which rows a file holds, all but the one that vouches for them: their checksums by key.
class HeldRows {
 public:
  void put(const TableShape& table, std::int64_t key, std::uint64_t checksum);
  void erase(const TableShape& table, std::int64_t key);
  /// Null when there is no such row.
  const std::uint64_t* find(const TableShape& table, std::int64_t key) const;
  /// The sum of all checksums.
  std::uint64_t digest() const { return digest_; }
  bool empty() const { return tables_.empty(); }
  void clear() { *this = {}; }

  const std::unordered_map<std::int64_t, std::uint64_t>& of(const TableShape& table) {
    return tables_[&table];
  }

 private:
  std::map<const TableShape*, std::unordered_map<std::int64_t, std::uint64_t>> tables_;
  std::uint64_t digest_ = 0;
};

void make_schema(Database& database);

/// Makes the database, whose rows are `held`, hold the atlas; `held` are its rows afterwards. The
/// number of rows written or deleted.
///
/// With `before`, the atlas that the database holds, only what is not shared with that is looked
/// at, which costs as much as has changed; without, every row is made and its checksum compared.
/// After a Fault neither the database nor `held` are to be believed.
std::int64_t write_rows(Database& database, const Atlas& atlas, const Atlas* before,
                        HeldRows& held);

/// A map and the rows that it was read from.
struct ReadMap {
  Atlas atlas;
  HeldRows rows;
  std::int64_t version = kVersion;  ///< of the file
};
/// The map in a file. @throws Fault as load_map fails, without the name.
ReadMap read_rows(const std::filesystem::path& file, const MapKey& key = {});

/// Which words the words of a row are: another vocabulary has another mark.
std::int64_t vocabulary_mark();

}  // namespace ydd::map_format
