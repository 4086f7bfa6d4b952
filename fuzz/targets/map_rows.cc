// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/map_files/database.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_schema.h"
#include "ydd/map_files/stored_map.h"

namespace ydd::fuzz {
namespace {

using namespace map_format;  // NOLINT(google-build-using-namespace): all of it is tried

/// Whole numbers up to 127 in one byte, others in four or eight; bytes with their length before.
Value value_of(Pieces& pieces) {
  const std::uint8_t kind = pieces.byte();
  if (kind < 128) return std::int64_t{kind};
  if (kind < 144) return std::int64_t{pieces.number()};
  if (kind < 152) {
    const std::uint64_t high = pieces.number();
    return static_cast<std::int64_t>((high << 32U) | pieces.number());
  }
  const std::size_t size = kind < 255 ? kind - 152U : pieces.byte() + 256U * pieces.byte();
  return std::string(pieces.text(size));
}

/// What a camera would ask of the map: nothing of it is believed because a load would refuse it.
void read_in_parts(const std::filesystem::path& file) {
  Result<StoredMap> stored = StoredMap::open(file);
  expect_one_line(stored);
  if (!stored || !stored->has_parts()) return;
  expect_one_line(stored->word_index(1000));
  const KeyFrameId newest = stored->newest_keyframe();
  for (const std::size_t most : {3U, 100U}) {
    const auto near = stored->neighbourhood({&newest, 1}, most);
    expect_one_line(near);
    if (!near) continue;
    const auto part = stored->part({near->begin(), near->end()});
    expect_one_line(part);
    if (!part) continue;
    (*part)->points().for_each([&](MapPointId id, const MapPoint& point) {
      for (const Observation& o : point.observations) {
        if ((*part)->at(o.keyframe).points.at(static_cast<std::size_t>(o.keypoint)) != id) {
          broken("a part with links that do not hold");
        }
      }
    });
  }
}

}  // namespace

// Rows for the tables of a map: which table, key, cells. Checksums and digest are right, which
// keeps a fuzzer out otherwise; so what is tried are the blobs and how the rows belong together.
void map_rows(std::string_view input) {
  static const Folder folder;
  const std::filesystem::path file = folder.path() / "rows.map";
  std::filesystem::remove(file);
  Pieces pieces(input);
  {
    Database database(file, Database::Mode::create);
    database.run("BEGIN");
    database.run("PRAGMA application_id = " + std::to_string(kApplicationId));
    database.run("PRAGMA user_version = " + std::to_string(kVersion));
    for (const TableShape* const table : kTables) database.create_table(*table);
    std::uint64_t digest = 0;
    std::map<std::pair<std::size_t, std::int64_t>, std::uint64_t> checksums;
    Row atlas;
    for (std::size_t i = 0; i < kAtlas.columns.size(); ++i)
      atlas.values.push_back(value_of(pieces));
    while (!pieces.done()) {
      const std::size_t which = pieces.byte() % std::size(kContent);
      Row row;
      const Value key = value_of(pieces);
      if (const auto* const number = std::get_if<std::int64_t>(&key)) row.key = *number;
      for (std::size_t i = 0; i < kContent[which]->columns.size(); ++i) {
        row.values.push_back(value_of(pieces));
      }
      const std::uint64_t checksum = checksum_of(*kContent[which], row);
      digest -= std::exchange(checksums[{which, row.key}], checksum);
      digest += checksum;
      database.put(*kContent[which], row, checksum);
    }
    atlas.values.back() = static_cast<std::int64_t>(digest);
    database.put(kAtlas, atlas, checksum_of(kAtlas, atlas));
    database.run("COMMIT");
  }
  const Result<Atlas> loaded = load_map(file);
  expect_one_line(loaded);
  if (loaded && !loaded->check_consistency().empty()) broken("links that do not hold");
  read_in_parts(file);
}

}  // namespace ydd::fuzz
