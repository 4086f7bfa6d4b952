// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_rows.h"

#include <algorithm>
#include <bit>
#include <string>
#include <unordered_set>
#include <vector>

#include <fmt/format.h>

#include "ydd/base/checksum.h"
#include "ydd/base/version.h"
#include "ydd/map_files/map_blobs.h"
#include "ydd/map_files/row_values.h"

namespace ydd::map_format {
namespace {

/// Those whose key is the slot of a keyframe.
const TableShape* const kKeyframeTables[] = {&kKeyframe, &kFeatures, &kWords, &kPicture};

std::int64_t whole(std::uint64_t value) { return static_cast<std::int64_t>(value); }

/// Puts those rows into the database that it does not hold yet.
class RowSink {
 public:
  RowSink(Database& database, HeldRows& held) : database_(database), held_(held) {}

  void put(const TableShape& table, const Row& row) {
    const std::uint64_t checksum = checksum_of(table, row);
    const std::uint64_t* const held = held_.find(table, row.key);
    if (held && *held == checksum) return;
    database_.put(table, row, checksum);
    held_.put(table, row.key, checksum);
    ++rows_;
  }
  void erase(const TableShape& table, std::int64_t key) {
    if (!held_.find(table, key)) return;
    database_.erase(table, key);
    held_.erase(table, key);
    ++rows_;
  }
  /// Deletes the rows of a table that `stays` does not want.
  template <class Stays>
  void erase_unless(const TableShape& table, Stays&& stays) {
    std::vector<std::int64_t> goes;
    for (const auto& [key, checksum] : held_.of(table)) {
      if (!stays(key)) goes.push_back(key);
    }
    std::sort(goes.begin(), goes.end());
    for (const std::int64_t key : goes) erase(table, key);
  }
  std::int64_t rows() const { return rows_; }

 private:
  Database& database_;
  HeldRows& held_;
  std::int64_t rows_ = 0;
};

/// `old` is the keyframe as the file holds it; null: unknown.
void put_keyframe(RowSink& sink, KeyFrameId id, const KeyFrame& k, const KeyFrame* old) {
  sink.put(kKeyframe,
           {id.slot,
            {whole(id.generation), k.serial, k.frame_index, k.stamp.ns, whole(k.map.slot),
             whole(k.parent.slot), whole(k.parent.generation), encode_pose(k.T_world_camera),
             encode_covisible(k.covisible), encode_ids(k.loops), encode_blocks_of(k.points)}});
  if (!old || old->shared_features != k.shared_features) {
    sink.put(kFeatures, {id.slot, {whole(id.generation), encode_features(k.features())}});
  }
  if (!old || old->words != k.words) {
    const auto words = k.words ? k.words : words_of(k);
    sink.put(kWords,
             {id.slot, {whole(id.generation), k.serial, vocabulary_mark(), encode_bag(*words)}});
  }
  if (!k.picture) {
    sink.erase(kPicture, id.slot);
  } else if (!old || old->picture != k.picture) {
    sink.put(kPicture,
             {id.slot,
              {whole(id.generation), whole(static_cast<std::uint64_t>(k.picture->width_px)),
               whole(static_cast<std::uint64_t>(k.picture->height_px)), k.picture->colour_jpeg,
               k.picture->depth_png}});
  }
}

void erase_keyframe(RowSink& sink, std::uint32_t slot) {
  for (const TableShape* const table : kKeyframeTables) {
    sink.erase(*table, slot);
  }
}

/// Points of slots [first, first + kPointsPerBlock): a row, or none where there are none.
void put_points(RowSink& sink, const Atlas& atlas, std::uint32_t first) {
  PointBlock block;
  bool empty = true;
  atlas.points().for_each_in(first, first + kPointsPerBlock,
                             [&](MapPointId id, const MapPoint& point) {
                               block.add(id, point);
                               empty = false;
                             });
  const std::int64_t key = first / kPointsPerBlock;
  if (empty) {
    sink.erase(kPoints, key);
  } else {
    sink.put(kPoints, {key, {block.take()}});
  }
}

std::int64_t key_of_culled(KeyFrameId id) {
  return whole(static_cast<std::uint64_t>(id.generation) << 32U | id.slot);
}

void put_culled(RowSink& sink, KeyFrameId id, const CulledKeyFrame& culled) {
  sink.put(kCulled, {key_of_culled(id),
                     {whole(culled.parent.slot), whole(culled.parent.generation),
                      encode_pose(culled.T_parent_keyframe)}});
}

void put_all(RowSink& sink, const Atlas& atlas) {
  std::unordered_set<std::int64_t> keyframes, culled;
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    put_keyframe(sink, id, keyframe, nullptr);
    keyframes.insert(id.slot);
  });
  for (const TableShape* const table : kKeyframeTables) {
    sink.erase_unless(*table, [&](std::int64_t key) { return keyframes.contains(key); });
  }
  atlas.culled().for_each([&](KeyFrameId id, const CulledKeyFrame& value) {
    put_culled(sink, id, value);
    culled.insert(key_of_culled(id));
  });
  sink.erase_unless(kCulled, [&](std::int64_t key) { return culled.contains(key); });
  const std::uint32_t slots = atlas.points().slots();
  for (std::uint32_t first = 0; first < slots; first += kPointsPerBlock) {
    put_points(sink, atlas, first);
  }
  sink.erase_unless(kPoints, [&](std::int64_t key) { return key * kPointsPerBlock < slots; });
}

void put_differences(RowSink& sink, const Atlas& atlas, const Atlas& before) {
  atlas.keyframes().for_each_difference(
      before.keyframes(), [&](std::uint32_t first, std::uint32_t end) {
        before.keyframes().for_each_in(first, end, [&](KeyFrameId id, const KeyFrame&) {
          if (!atlas.find(id)) erase_keyframe(sink, id.slot);
        });
        atlas.keyframes().for_each_in(first, end, [&](KeyFrameId id, const KeyFrame& keyframe) {
          const KeyFrame* const old = before.find(id);
          if (old != &keyframe) put_keyframe(sink, id, keyframe, old);
        });
      });
  before.culled().for_each_difference(atlas.culled(), [&](KeyFrameId id, const CulledKeyFrame&) {
    if (!atlas.culled().contains(id)) sink.erase(kCulled, key_of_culled(id));
  });
  atlas.culled().for_each_difference(
      before.culled(),
      [&](KeyFrameId id, const CulledKeyFrame& culled) { put_culled(sink, id, culled); });
  atlas.points().for_each_difference(before.points(), [&](std::uint32_t first, std::uint32_t end) {
    for (; first < end; first += kPointsPerBlock) put_points(sink, atlas, first);
  });
}

/// Always written: it changes whenever anything does.
void put_atlas_row(Database& database, const Atlas& atlas, std::uint64_t digest) {
  const KeyFrameId newest = atlas.newest_keyframe();
  const Row row{
      1,
      {std::string("ydd-slam ") + ydd::kVersion, atlas.camera().name, encode_camera(atlas.camera()),
       encode_scales(atlas.scales()), whole(atlas.revision()), atlas.next_serial(),
       whole(atlas.maps()), whole(newest.slot), whole(newest.generation),
       encode_ids(atlas.keyframes().freed()), encode_ids(atlas.points().freed()),
       whole(atlas.keyframes().size()), whole(atlas.points().size()), whole(digest)}};
  database.put(kAtlas, row, checksum_of(kAtlas, row));
}

}  // namespace

std::int64_t vocabulary_mark() {
  static const std::uint64_t mark = [] {
    const VocabularyTree& tree = builtin_vocabulary();
    Checksum sum;
    sum.add(static_cast<std::uint64_t>(tree.branching));
    sum.add(static_cast<std::uint64_t>(tree.levels));
    for (const Descriptor& node : tree.nodes) {
      for (const std::uint64_t word : node) sum.add(word);
    }
    for (const float weight : tree.leaf_weights) sum.add(std::bit_cast<std::uint32_t>(weight));
    return sum.value();
  }();
  return whole(mark);
}

void HeldRows::put(const TableShape& table, std::int64_t key, std::uint64_t checksum) {
  const auto [entry, is_new] = tables_[&table].try_emplace(key, checksum);
  if (!is_new) digest_ -= std::exchange(entry->second, checksum);
  digest_ += checksum;
}

void HeldRows::erase(const TableShape& table, std::int64_t key) {
  auto& rows = tables_[&table];
  const auto found = rows.find(key);
  if (found == rows.end()) return;
  digest_ -= found->second;
  rows.erase(found);
}

const std::uint64_t* HeldRows::find(const TableShape& table, std::int64_t key) const {
  const auto rows = tables_.find(&table);
  if (rows == tables_.end()) return nullptr;
  const auto row = rows->second.find(key);
  return row == rows->second.end() ? nullptr : &row->second;
}

void make_schema(Database& database) {
  database.run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId,
                           kVersion));
  database.create_table(kAtlas);
  for (const TableShape* const table : kContent) database.create_table(*table);
}

std::int64_t write_rows(Database& database, const Atlas& atlas, const Atlas* before,
                        HeldRows& held) {
  RowSink sink(database, held);
  if (before) {
    put_differences(sink, atlas, *before);
  } else {
    put_all(sink, atlas);
  }
  put_atlas_row(database, atlas, held.digest());
  return sink.rows() + 1;
}

}  // namespace ydd::map_format
