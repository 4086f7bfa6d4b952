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
    database_.run("BEGIN");                        // everything from one save, whoever is writing
    database_.expect_tables(map_format::kTables);  // before the check, which computes what it finds
    if (std::string check = database_.text("PRAGMA quick_check(1)"); check != "ok") {
      std::replace(check.begin(), check.end(), '\n', ' ');  // a heading, then what is wrong
      throw Fault(check);
    }
    const std::int64_t version = database_.number("PRAGMA user_version");
    if (version != map_format::kVersion) throw Fault(fmt::format("format {}", version));
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

 private:
  Database database_;
  map_format::HeldRows held_;
};

std::uint32_t slot_of(const Row& row) {
  if (row.key < 0 || row.key > UINT32_MAX) throw Fault("a slot that is too large");
  return static_cast<std::uint32_t>(row.key);
}

struct Totals {
  std::uint32_t keyframes = 0;
  std::uint32_t points = 0;
  std::uint64_t digest = 0;
};

constexpr std::uint32_t kMostMaps = 1'000'000;

Totals read_atlas_row(const Row& row, AtlasParts& parts) {
  parts.camera = map_format::decode_camera(row.bytes(2));
  parts.camera.name = row.bytes(1);
  parts.scales = map_format::decode_scales(row.bytes(3));
  parts.revision = static_cast<std::uint64_t>(row.integer(4));
  parts.next_serial = row.integer(5);
  parts.maps = row.number(6, kMostMaps);
  parts.newest = {row.number(7), row.number(8)};
  parts.freed_keyframes = map_format::decode_ids<KeyFrameTag>(row.bytes(9));
  parts.freed_points = map_format::decode_ids<MapPointTag>(row.bytes(10));
  return {row.number(11), row.number(12), static_cast<std::uint64_t>(row.integer(13))};
}

void read_keyframes(Reader& reader, AtlasParts& parts) {
  reader.rows(map_format::kKeyframe, [&](const Row& row) {
    KeyFrame k;
    k.serial = row.integer(1);
    k.frame_index = row.integer(2);
    k.stamp = {row.integer(3)};
    k.map = {row.number(4), 1};
    k.parent = {row.number(5), row.number(6)};
    k.T_world_camera = map_format::decode_pose(row.bytes(7));
    k.covisible = map_format::decode_covisible(row.bytes(8));
    k.loops = map_format::decode_ids<KeyFrameTag>(row.bytes(9));
    parts.keyframes.emplace_back(KeyFrameId{slot_of(row), row.number(0)}, std::move(k));
  });
}

/// The keyframe that a row of another table belongs to.
KeyFrame& keyframe_of(const Row& row, AtlasParts& parts) {
  const KeyFrameId id{slot_of(row), row.number(0)};
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
    KeyFrame& keyframe = keyframe_of(row, parts);
    const auto features =
        std::make_shared<const Features>(map_format::decode_features(row.bytes(1)));
    keyframe.grid = std::make_shared<const KeypointGrid>(*features, parts.camera);
    keyframe.words = std::make_shared<const BagOfWords>(
        bag_of_words(builtin_vocabulary(), features->descriptors));
    keyframe.shared_features = features;
  });
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

std::pair<Atlas, map_format::HeldRows> map_format::read_rows(const std::filesystem::path& file,
                                                             const MapKey& key) {
  check_header(file, key);
  try {
    recover(file, key);
    Reader reader(file, key);
    AtlasParts parts;
    const Totals totals = read_atlas_row(reader.atlas_row(), parts);
    read_keyframes(reader, parts);
    read_features(reader, parts);
    read_pictures(reader, parts);
    read_culled(reader, parts);
    read_points(reader, parts);
    if (reader.held().digest() != totals.digest || parts.keyframes.size() != totals.keyframes ||
        parts.points.size() != totals.points) {
      throw Fault("rows of it are missing, or not of one save");
    }
    Result<Atlas> atlas = Atlas::restore(std::move(parts));
    if (!atlas) throw Fault(atlas.error().message);
    return {std::move(*atlas), reader.held()};
  } catch (const Refused&) {
    throw;
  } catch (const Fault& fault) {
    throw Fault(fmt::format("is damaged ({}); go back to a copy of it", fault.what()));
  }
}

Result<Atlas> load_map(const std::filesystem::path& file, const MapKey& key) {
  try {
    return map_format::read_rows(file, key).first;
  } catch (const std::exception& fault) {  // also what the file system has to say
    return Error{fmt::format("{}: {}", file.string(), fault.what())};
  }
}

}  // namespace ydd
