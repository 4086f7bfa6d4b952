// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ydd/map_files/map_blobs.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_header.h"
#include "ydd/map_files/map_rows.h"
#include "ydd/map_files/map_schema.h"
#include "ydd/map_files/row_values.h"

namespace ydd {
namespace {

using map_format::Database;
using map_format::Fault;
using map_format::Row;

/// Reads tables and remembers what their rows add up to.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const MapKey& key)
      : database_(file, Database::Mode::read, key) {
    database_.run("BEGIN");  // everything from one save, whoever is writing
    version_ = database_.number("PRAGMA user_version");
    // Before the check, which computes what it finds.
    database_.expect_tables(map_format::tables_of(version_));
    if (std::string check = database_.text("PRAGMA quick_check(1)"); check != "ok") {
      std::replace(check.begin(), check.end(), '\n', ' ');  // a heading, then what is wrong
      throw Fault(check);
    }
    if (version_ < 1 || version_ > map_format::kVersion) {
      throw Fault(fmt::format("format {}", version_));
    }
  }

  template <class Visit>
  void rows(const map_format::TableShape& table, Visit&& visit) {
    database_.for_each(table, [&](const Row& row, std::uint64_t checksum) {
      held_.put(table, row.key, checksum);
      visit(row);
    });
  }
  /// The one row of kAtlas, which carries the digest of the others and is not part of it.
  Row atlas_row() {
    std::vector<Row> rows;
    database_.for_each(map_format::kAtlas, [&](const Row& row, std::uint64_t) {
      if (!rows.empty()) throw Fault("it says twice what is inside");
      rows.push_back(row);
    });
    if (rows.empty()) throw Fault("it does not say what is inside");
    return std::move(rows.front());
  }
  const map_format::HeldRows& held() const { return held_; }
  std::int64_t version() const { return version_; }

 private:
  Database database_;
  std::int64_t version_ = 0;
  map_format::HeldRows held_;
};

/// What rows of keyframes say about other rows, as bytes.
using BlockLists = std::vector<std::pair<KeyFrameId, std::string>>;

BlockLists read_keyframes(Reader& reader, AtlasParts& parts) {
  BlockLists lists;
  const bool old = reader.version() == 1;
  reader.rows(old ? map_format::kKeyframe1 : map_format::kKeyframe, [&](const Row& row) {
    const KeyFrameId id = map_format::keyframe_id_of(row);
    parts.keyframes.emplace_back(id, map_format::decode_keyframe_row(row));
    if (!old) lists.emplace_back(id, row.bytes(10));
  });
  return lists;
}

/// What a part of the map would be read by must lead to the points that there are.
void check_blocks(const Atlas& atlas, const BlockLists& lists) {
  for (const auto& [id, bytes] : lists) {
    if (map_format::encode_blocks_of(atlas.at(id).points) != bytes) {
      throw Fault(fmt::format("keyframe {}: its points lie elsewhere", id.slot));
    }
  }
}

/// The keyframe that a row of another table belongs to.
KeyFrame& keyframe_of(const Row& row, AtlasParts& parts) {
  const KeyFrameId id = map_format::keyframe_id_of(row);
  const auto found =
      std::lower_bound(parts.keyframes.begin(), parts.keyframes.end(), id,
                       [](const auto& entry, KeyFrameId i) { return entry.first < i; });
  if (found == parts.keyframes.end() || found->first != id) {
    throw Fault(fmt::format("what keyframe {} saw, but no such keyframe", id.slot));
  }
  return found->second;
}

void read_features(Reader& reader, AtlasParts& parts) {
  reader.rows(map_format::kFeatures, [&](const Row& row) {
    map_format::decode_features_row(row, parts.camera, keyframe_of(row, parts));
  });
}

void read_words(Reader& reader, AtlasParts& parts) {
  if (reader.version() > 1) {
    reader.rows(map_format::kWords, [&](const Row& row) {
      KeyFrame& keyframe = keyframe_of(row, parts);
      if (auto bag = map_format::decode_words_row(row)) {
        keyframe.words = std::make_shared<const BagOfWords>(*std::move(bag));
      }
    });
  }
  for (auto& [id, keyframe] : parts.keyframes) {
    if (keyframe.shared_features && !keyframe.words)
      keyframe.words = map_format::words_of(keyframe);
  }
}

void read_pictures(Reader& reader, AtlasParts& parts) {
  constexpr std::uint32_t kLargest_px = 100'000;
  reader.rows(map_format::kPicture, [&](const Row& row) {
    KeyFramePicture picture;
    picture.width_px = static_cast<int>(row.number(1, kLargest_px));
    picture.height_px = static_cast<int>(row.number(2, kLargest_px));
    picture.colour_jpeg = row.bytes(3);
    picture.depth_png = row.bytes(4);
    keyframe_of(row, parts).picture = std::make_shared<const KeyFramePicture>(std::move(picture));
  });
}

void read_culled(Reader& reader, AtlasParts& parts) {
  reader.rows(map_format::kCulled, [&](const Row& row) {
    const auto key = static_cast<std::uint64_t>(row.key);
    const KeyFrameId id{static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32U)};
    parts.culled[id] = {{row.number(0), row.number(1)}, map_format::decode_pose(row.bytes(2))};
  });
}

void read_points(Reader& reader, AtlasParts& parts) {
  reader.rows(map_format::kPoints,
              [&](const Row& row) { map_format::decode_points(row.bytes(0), parts.points); });
}

}  // namespace

map_format::ReadMap map_format::read_rows(const std::filesystem::path& file, const MapKey& key) {
  check_header(file, key);
  try {
    recover(file, key);
    Reader reader(file, key);
    AtlasRow totals = decode_atlas_row(reader.atlas_row());
    AtlasParts parts = std::move(totals.parts);
    const BlockLists lists = read_keyframes(reader, parts);
    read_features(reader, parts);
    read_words(reader, parts);
    read_pictures(reader, parts);
    read_culled(reader, parts);
    read_points(reader, parts);
    if (reader.held().digest() != totals.digest || parts.keyframes.size() != totals.keyframes ||
        parts.points.size() != totals.points) {
      throw Fault("rows of it are missing, or not of one save");
    }
    Result<Atlas> atlas = Atlas::restore(std::move(parts));
    if (!atlas) throw Fault(atlas.error().message);
    check_blocks(*atlas, lists);
    return {std::move(*atlas), reader.held(), reader.version()};
  } catch (const Refused&) {
    throw;
  } catch (const Fault& fault) {
    throw Fault(fmt::format("is damaged ({}); go back to a copy of it", fault.what()));
  }
}

Result<Atlas> load_map(const std::filesystem::path& file, const MapKey& key) {
  try {
    return map_format::read_rows(file, key).atlas;
  } catch (const std::exception& fault) {  // also what the file system has to say
    return Error{fmt::format("{}: {}", file.string(), fault.what())};
  }
}

}  // namespace ydd
