// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/stored_map.h"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "ydd/map_files/map_blobs.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_header.h"
#include "ydd/map_files/map_rows.h"
#include "ydd/map_files/map_schema.h"
#include "ydd/map_files/row_values.h"

namespace ydd {

using map_format::Database;
using map_format::Fault;
using map_format::Row;

namespace {

std::string damaged(const std::filesystem::path& file, const std::exception& fault) {
  return fmt::format("{}: is damaged ({}); go back to a copy of it", file.string(), fault.what());
}

}  // namespace

/// Rows of the file, and what has been made of those that are in use.
class StoredMap::Reader {
 public:
  Reader(const std::filesystem::path& file, const MapKey& key)
      : file_(file), database_(opened(file, key)), atlas_(read_atlas_row()) {}

  const std::filesystem::path& file() const { return file_; }
  const map_format::AtlasRow& atlas() const { return atlas_; }

  bool has_parts() {
    if (version_ < map_format::kVersion) return false;
    if (!atlas_.parts.newest.valid()) return false;
    const std::optional<Row> words = database_.find(map_format::kWords, atlas_.parts.newest.slot);
    return words && words->integer(2) == map_format::vocabulary_mark();
  }

  WordIndex word_index(std::size_t most_postings);
  std::shared_ptr<const BagOfWords> words(KeyFrameId id);
  const KeyFrame& links(KeyFrameId id) { return known(id).keyframe; }
  std::vector<KeyFrameId> neighbourhood(std::span<const KeyFrameId> centres, std::size_t most);
  Atlas part(const std::set<KeyFrameId>& wanted);

  /// Gives the step its time, and its fault the name of the file.
  template <class Step>
  auto named(Step&& step) {
    try {
      database_.renew_patience();
      return step();
    } catch (const Fault& fault) {
      throw std::runtime_error(damaged(file_, fault));
    }
  }

 private:
  /// A keyframe as its row has it, and whatever else has been read of it.
  struct Known {
    KeyFrame keyframe;
    std::vector<std::uint32_t> blocks;
  };
  using Block = std::vector<std::pair<MapPointId, MapPoint>>;

  static Database opened(const std::filesystem::path& file, const MapKey& key);
  map_format::AtlasRow read_atlas_row();
  bool is_kept(KeyFrameId id);
  Known& known(KeyFrameId id);
  const Row& of_keyframe(const std::optional<Row>& row, KeyFrameId id) const;
  void read_what_it_saw(KeyFrameId id, Known& known);
  void forget_all_but(const std::set<KeyFrameId>& wanted);
  void read_blocks(const std::set<KeyFrameId>& wanted);

  std::filesystem::path file_;
  Database database_;
  std::int64_t version_ = 0;
  map_format::AtlasRow atlas_;
  std::map<KeyFrameId, Known> known_;
  std::map<std::uint32_t, Block> blocks_;
  std::map<KeyFrameId, FarKeyFrame> far_;  ///< that were in an earlier part
};

Database StoredMap::Reader::opened(const std::filesystem::path& file, const MapKey& key) {
  map_format::recover(file, key);
  Database database(file, Database::Mode::read, key);
  database.run("BEGIN");  // all parts are of one save
  return database;
}

map_format::AtlasRow StoredMap::Reader::read_atlas_row() {
  version_ = database_.number("PRAGMA user_version");
  if (version_ < 1 || version_ > map_format::kVersion) throw Fault("of no known format");
  database_.expect_tables(map_format::tables_of(version_));
  const std::optional<Row> row = database_.find(map_format::kAtlas, 1);
  if (!row) throw Fault("it does not say what is inside");
  return map_format::decode_atlas_row(*row);
}

bool StoredMap::Reader::is_kept(KeyFrameId id) {
  if (known_.contains(id)) return true;
  const std::optional<Row> row = database_.find(map_format::kKeyframe, id.slot);
  return row && row->number(0) == id.generation;
}

const Row& StoredMap::Reader::of_keyframe(const std::optional<Row>& row, KeyFrameId id) const {
  if (!row || row->number(0) != id.generation) {
    throw Fault(fmt::format("rows of keyframe {} are missing", id.slot));
  }
  return *row;
}

StoredMap::Reader::Known& StoredMap::Reader::known(KeyFrameId id) {
  const auto found = known_.find(id);
  if (found != known_.end()) return found->second;
  const std::optional<Row> row = database_.find(map_format::kKeyframe, id.slot);
  KeyFrame keyframe = map_format::decode_keyframe_row(of_keyframe(row, id));
  return known_.emplace(id, Known{std::move(keyframe), map_format::decode_block_list(*row)})
      .first->second;
}

std::shared_ptr<const BagOfWords> StoredMap::Reader::words(KeyFrameId id) {
  const auto found = known_.find(id);
  if (found != known_.end() && found->second.keyframe.words) return found->second.keyframe.words;
  const std::optional<Row> row = database_.find(map_format::kWords, id.slot);
  auto bag = map_format::decode_words_row(of_keyframe(row, id));
  if (!bag) throw Fault(fmt::format("words of keyframe {} are of another vocabulary", id.slot));
  return std::make_shared<const BagOfWords>(*std::move(bag));
}

void StoredMap::Reader::read_what_it_saw(KeyFrameId id, Known& known) {
  if (known.keyframe.shared_features) return;
  const std::optional<Row> row = database_.find(map_format::kFeatures, id.slot);
  map_format::decode_features_row(of_keyframe(row, id), atlas_.parts.camera, known.keyframe);
  known.keyframe.words = database_.find(map_format::kWords, id.slot)
                             ? words(id)
                             : map_format::words_of(known.keyframe);
}

WordIndex StoredMap::Reader::word_index(std::size_t most_postings) {
  std::vector<WordIndex::Entry> entries;
  entries.reserve(atlas_.keyframes);
  database_.for_each(map_format::kWords, [&](const Row& row, std::uint64_t) {
    auto bag = map_format::decode_words_row(row);
    if (!bag) throw Fault("words of another vocabulary");
    entries.push_back({row.integer(1), map_format::keyframe_id_of(row),
                       std::make_shared<const BagOfWords>(*std::move(bag))});
  });
  return WordIndex::without_bags(std::move(entries), most_postings);
}

std::vector<KeyFrameId> StoredMap::Reader::neighbourhood(std::span<const KeyFrameId> centres,
                                                         std::size_t most) {
  std::vector<KeyFrameId> out;
  std::set<KeyFrameId> reached;
  const auto step = [&](KeyFrameId id) {
    if (id.valid() && out.size() < most && reached.insert(id).second) out.push_back(id);
  };
  for (const KeyFrameId id : centres) step(id);
  for (std::size_t at = 0; at < out.size() && out.size() < most; ++at) {
    const KeyFrame& keyframe = links(out[at]);
    for (const Covisible& c : keyframe.covisible) step(c.keyframe);
    step(keyframe.parent);
    for (const KeyFrameId id : keyframe.loops) {
      if (is_kept(id)) step(id);  // what closed the loop may have been culled since
    }
  }
  return out;
}

void StoredMap::Reader::forget_all_but(const std::set<KeyFrameId>& wanted) {
  for (auto it = known_.begin(); it != known_.end();) {
    if (wanted.contains(it->first)) {
      ++it;
      continue;
    }
    const KeyFrame& keyframe = it->second.keyframe;
    if (keyframe.shared_features) far_[it->first] = {keyframe.map, keyframe.T_world_camera};
    it = known_.erase(it);
  }
}

void StoredMap::Reader::read_blocks(const std::set<KeyFrameId>& wanted) {
  std::set<std::uint32_t> needed;
  for (const KeyFrameId id : wanted) {
    const std::vector<std::uint32_t>& blocks = known_.at(id).blocks;
    needed.insert(blocks.begin(), blocks.end());
  }
  std::erase_if(blocks_, [&](const auto& entry) { return !needed.contains(entry.first); });
  for (const std::uint32_t number : needed) {
    if (blocks_.contains(number)) continue;
    const std::optional<Row> row = database_.find(map_format::kPoints, number);
    if (!row) throw Fault(fmt::format("points {} are missing", number));
    map_format::decode_points(row->bytes(0), blocks_[number]);
  }
}

Atlas StoredMap::Reader::part(const std::set<KeyFrameId>& wanted) {
  forget_all_but(wanted);
  for (const KeyFrameId id : wanted) read_what_it_saw(id, known(id));
  read_blocks(wanted);
  AtlasPart part;
  AtlasParts& parts = part.parts;
  parts.camera = atlas_.parts.camera;
  parts.scales = atlas_.parts.scales;
  parts.revision = atlas_.parts.revision;
  parts.newest = atlas_.parts.newest;
  parts.next_serial = atlas_.parts.next_serial;
  parts.maps = atlas_.parts.maps;
  for (const KeyFrameId id : wanted) {
    parts.keyframes.emplace_back(id, known_.at(id).keyframe);
    far_.erase(id);
  }
  for (const auto& [number, block] : blocks_) {
    parts.points.insert(parts.points.end(), block.begin(), block.end());
  }
  part.keyframe_slots = atlas_.keyframe_slots();
  part.point_slots = atlas_.point_slots();
  part.far = far_;
  Result<Atlas> atlas = Atlas::restore_part(std::move(part));
  if (!atlas) throw Fault(atlas.error().message);
  return std::move(*atlas);
}

StoredMap::StoredMap(std::unique_ptr<Reader> reader) : reader_(std::move(reader)) {}
StoredMap::StoredMap(StoredMap&&) noexcept = default;
StoredMap& StoredMap::operator=(StoredMap&&) noexcept = default;
StoredMap::~StoredMap() = default;

Result<StoredMap> StoredMap::open(const std::filesystem::path& file, const MapKey& key) {
  try {
    map_format::check_header(file, key);
  } catch (const std::exception& fault) {
    return Error{fmt::format("{}: {}", file.string(), fault.what())};
  }
  try {
    return StoredMap(std::make_unique<Reader>(file, key));
  } catch (const map_format::Refused& refused) {
    return Error{fmt::format("{}: {}", file.string(), refused.what())};
  } catch (const std::exception& fault) {
    return Error{damaged(file, fault)};
  }
}

const std::filesystem::path& StoredMap::file() const { return reader_->file(); }
const Camera& StoredMap::camera() const { return reader_->atlas().parts.camera; }
const PyramidScales& StoredMap::scales() const { return reader_->atlas().parts.scales; }
std::size_t StoredMap::keyframes() const { return reader_->atlas().keyframes; }
std::size_t StoredMap::points() const { return reader_->atlas().points; }
KeyFrameId StoredMap::newest_keyframe() const { return reader_->atlas().parts.newest; }

bool StoredMap::has_parts() const {
  try {
    return reader_->has_parts();
  } catch (const std::exception&) {
    return false;  // load_map will say what is wrong
  }
}

Result<WordIndex> StoredMap::word_index(std::size_t most_postings) {
  try {
    return reader_->named([&] { return reader_->word_index(most_postings); });
  } catch (const std::exception& fault) {
    return Error{fault.what()};
  }
}

std::shared_ptr<const BagOfWords> StoredMap::words(KeyFrameId keyframe) {
  return reader_->named([&] { return reader_->words(keyframe); });
}

std::vector<Covisible> StoredMap::neighbours(KeyFrameId keyframe) {
  return reader_->named([&] { return reader_->links(keyframe).covisible; });
}

Result<std::vector<KeyFrameId>> StoredMap::neighbourhood(std::span<const KeyFrameId> centres,
                                                         std::size_t most) {
  try {
    return reader_->named([&] { return reader_->neighbourhood(centres, most); });
  } catch (const std::exception& fault) {
    return Error{fault.what()};
  }
}

Result<std::shared_ptr<const Atlas>> StoredMap::part(const std::set<KeyFrameId>& keyframes) {
  try {
    return reader_->named([&]() -> Result<std::shared_ptr<const Atlas>> {
      return std::shared_ptr<const Atlas>(std::make_shared<Atlas>(reader_->part(keyframes)));
    });
  } catch (const std::exception& fault) {
    return Error{fault.what()};
  }
}

}  // namespace ydd
