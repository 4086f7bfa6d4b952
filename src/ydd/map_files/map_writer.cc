// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/file_lock.h"
#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/base/version.h"
#include "ydd/map_files/map_blobs.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_header.h"
#include "ydd/map_files/map_schema.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using map_format::Database;
using map_format::Fault;
using map_format::Row;
using map_format::TableShape;

/// What the file holds: the checksum of each row by its key, and the immutable value it was made of
/// (kept, so that no other value can come to lie at its address).
struct WrittenRow {
  std::uint64_t checksum = 0;
  std::shared_ptr<const void> source;
};
using Written = std::map<const TableShape*, std::map<std::int64_t, WrittenRow>>;

/// Puts those rows into the database that it does not hold yet.
class RowSink {
 public:
  RowSink(Database& database, const Written& before) : database_(database), before_(before) {}

  void put(const TableShape& table, const Row& row, std::shared_ptr<const void> source = {}) {
    const std::uint64_t checksum = map_format::checksum_of(table, row);
    after_[&table][row.key] = {checksum, std::move(source)};
    const WrittenRow* const held = find(table, row.key);
    if (held && held->checksum == checksum) return;
    database_.put(table, row, checksum);
    ++rows_;
  }

  /// For what never changes: true if the row is there already and need not be made.
  bool keep(const TableShape& table, std::int64_t key, const std::shared_ptr<const void>& source) {
    const WrittenRow* const held = find(table, key);
    if (!held || held->source != source) return false;
    after_[&table][key] = *held;
    return true;
  }

  /// Deletes the rows that were not put or kept.
  void erase_others() {
    for (const auto& [table, rows] : before_) {
      for (const auto& [key, row] : rows) {
        if (after_[table].contains(key)) continue;
        database_.erase(*table, key);
        ++rows_;
      }
    }
  }

  std::uint64_t digest() const {
    std::uint64_t digest = 0;
    for (const auto& [table, rows] : after_) {
      for (const auto& [key, row] : rows) digest += row.checksum;
    }
    return digest;
  }
  std::int64_t rows() const { return rows_; }
  Written take() && { return std::move(after_); }

 private:
  const WrittenRow* find(const TableShape& table, std::int64_t key) const {
    const auto rows = before_.find(&table);
    if (rows == before_.end()) return nullptr;
    const auto row = rows->second.find(key);
    return row == rows->second.end() ? nullptr : &row->second;
  }

  Database& database_;
  const Written& before_;
  Written after_;
  std::int64_t rows_ = 0;
};

std::int64_t whole(std::uint64_t value) { return static_cast<std::int64_t>(value); }

void put_keyframe(RowSink& sink, KeyFrameId id, const KeyFrame& k) {
  sink.put(
      map_format::kKeyframe,
      {id.slot,
       {whole(id.generation), k.serial, k.frame_index, k.stamp.ns, whole(k.map.slot),
        whole(k.parent.slot), whole(k.parent.generation), map_format::encode_pose(k.T_world_camera),
        map_format::encode_covisible(k.covisible), map_format::encode_ids(k.loops)}});
  if (!sink.keep(map_format::kFeatures, id.slot, k.shared_features)) {
    sink.put(map_format::kFeatures,
             {id.slot, {whole(id.generation), map_format::encode_features(k.features())}},
             k.shared_features);
  }
  if (k.picture && !sink.keep(map_format::kPicture, id.slot, k.picture)) {
    sink.put(map_format::kPicture,
             {id.slot,
              {whole(id.generation), whole(static_cast<std::uint64_t>(k.picture->width_px)),
               whole(static_cast<std::uint64_t>(k.picture->height_px)), k.picture->colour_jpeg,
               k.picture->depth_png}},
             k.picture);
  }
}

void put_points(RowSink& sink, const Atlas& atlas) {
  map_format::PointBlock block;
  std::optional<std::uint32_t> number;
  const auto flush = [&] {
    if (number) sink.put(map_format::kPoints, {*number, {block.take()}});
  };
  atlas.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (number != id.slot / map_format::kPointsPerBlock) flush();
    number = id.slot / map_format::kPointsPerBlock;
    block.add(id, point);
  });
  flush();
}

void put_culled(RowSink& sink, const Atlas& atlas) {
  atlas.culled().for_each([&](KeyFrameId id, const CulledKeyFrame& culled) {
    const std::uint64_t key = static_cast<std::uint64_t>(id.generation) << 32U | id.slot;
    sink.put(map_format::kCulled, {whole(key),
                                   {whole(culled.parent.slot), whole(culled.parent.generation),
                                    map_format::encode_pose(culled.T_parent_keyframe)}});
  });
}

/// Always written: it changes whenever anything does.
void put_atlas_row(Database& database, const Atlas& atlas, std::uint64_t digest) {
  const KeyFrameId newest = atlas.newest_keyframe();
  const Row row{
      1,
      {std::string("ydd-slam ") + kVersion, atlas.camera().name,
       map_format::encode_camera(atlas.camera()), map_format::encode_scales(atlas.scales()),
       whole(atlas.revision()), atlas.next_serial(), whole(atlas.maps()), whole(newest.slot),
       whole(newest.generation), map_format::encode_ids(atlas.keyframes().freed()),
       map_format::encode_ids(atlas.points().freed()), whole(atlas.keyframes().size()),
       whole(atlas.points().size()), whole(digest)}};
  database.put(map_format::kAtlas, row, map_format::checksum_of(map_format::kAtlas, row));
}

/// Makes the database, which holds `before`, hold the atlas.
std::pair<Written, std::int64_t> write_atlas(Database& database, const Atlas& atlas,
                                             const Written& before) {
  RowSink sink(database, before);
  atlas.keyframes().for_each(
      [&](KeyFrameId id, const KeyFrame& keyframe) { put_keyframe(sink, id, keyframe); });
  put_culled(sink, atlas);
  put_points(sink, atlas);
  sink.erase_others();
  put_atlas_row(database, atlas, sink.digest());
  const std::int64_t rows = sink.rows() + 1;
  return {std::move(sink).take(), rows};
}

void make_schema(Database& database) {
  database.run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                           map_format::kApplicationId, map_format::kVersion));
  database.create_table(map_format::kAtlas);
  for (const TableShape* const table : map_format::kContent) database.create_table(*table);
}

FileLock take_lock(const fs::path& file, bool create) {
  Result<FileLock> lock = FileLock::take(file, create);
  if (!lock) throw Fault(lock.error().message);
  return std::move(*lock);
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// What must not be lost in silence: how much a file holds, and of which keyframes.
struct Holding {
  std::vector<std::pair<KeyFrameId, Timestamp>> keyframes;
  std::size_t points = 0;

  bool empty() const { return keyframes.empty() || points == 0; }
};

Holding holding_of(const Atlas& atlas) {
  Holding holding{{}, atlas.points().size()};
  holding.keyframes.reserve(atlas.keyframes().size());
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    holding.keyframes.emplace_back(id, keyframe.stamp);
  });
  return holding;
}

/// Whether each keyframe of `old` is in the atlas, or was culled from it.
bool goes_on_from(const Holding& old, const Atlas& atlas) {
  return std::ranges::all_of(old.keyframes, [&](const auto& entry) {
    const KeyFrame* const keyframe = atlas.find(entry.first);
    return keyframe ? keyframe->stamp == entry.second : atlas.culled().contains(entry.first);
  });
}

/// A map that goes on may lose what has become redundant, but not most of itself.
bool is_lesser(const Atlas& atlas, const Holding& old) {
  const double kept = goes_on_from(old, atlas) ? 0.5 : 1.0;
  return static_cast<double>(atlas.keyframes().size()) <
             kept * static_cast<double>(old.keyframes.size()) ||
         static_cast<double>(atlas.points().size()) < kept * static_cast<double>(old.points);
}

fs::path previous_of(const fs::path& file) { return file.string() + ".previous"; }

/// Gives the file a second name, so that it stays when the first is given to another; true if it
/// has it now. A larger map that has that name already keeps it.
bool keep_previous(const fs::path& file, const Holding& old) {
  const fs::path previous = previous_of(file);
  if (fs::exists(fs::symlink_status(previous))) {
    const Result<Atlas> before = load_map(previous);
    if (!before) {
      throw Fault(fmt::format("its map cannot be kept as {}, as something else is there; move it",
                              previous.string()));
    }
    if (!is_lesser(*before, old)) {
      log::warning("{}: a lesser map replaces another one ({} keyframes, {} points); {} stays",
                   file.string(), old.keyframes.size(), old.points, previous.string());
      return false;
    }
    fs::remove(previous);
  }
  std::error_code no_second_names;
  fs::create_hard_link(file, previous, no_second_names);
  if (no_second_names) fs::copy_file(file, previous);
  log::warning("{}: the map of before ({} keyframes, {} points) holds more; it is kept as {}",
               file.string(), old.keyframes.size(), old.points, previous.string());
  return true;
}

Error failure(const fs::path& file, const char* reason) {
  const std::string_view text = reason;
  const bool named = text.starts_with(file.string());
  return named ? Error{std::string(text)} : Error{fmt::format("{}: {}", file.string(), text)};
}

}  // namespace

struct MapWriter::State {
  std::optional<FileLock> lock;  ///< of the file that is there; outlives the connection
  std::optional<Database> database;
  Written written;  ///< what the database holds
  Holding held;     ///< by the file
  bool replace = false;
  std::optional<Holding> previous;  ///< what was set aside for as long as there is less
};

MapWriter::MapWriter(fs::path file, std::unique_ptr<State> state)
    : file_(std::move(file)), state_(std::move(state)) {}
MapWriter::MapWriter(MapWriter&&) noexcept = default;
MapWriter& MapWriter::operator=(MapWriter&&) noexcept = default;
MapWriter::~MapWriter() = default;

Result<MapWriter> MapWriter::open(const fs::path& file, Replacing replacing) {
  try {
    // A link stays a link: what it leads to is replaced. Absolute first: the canonical path of a
    // file that is not there yet would stay relative.
    const fs::path target = map_file_target(file);
    auto state = std::make_unique<State>();
    state->replace = replacing == Replacing::anything;
    if (::access(folder_of(target).c_str(), W_OK | X_OK) != 0) {
      throw Fault("its folder is not there, or cannot be written to");
    }
    if (fs::exists(target)) {
      map_format::check_header(target);
      map_format::recover(target);
      state->lock = take_lock(target, false);
      const Result<Atlas> held = load_map(target);
      if (!held) throw Fault(held.error().message);
      state->held = holding_of(*held);
    }
    return MapWriter(target, std::move(state));
  } catch (const std::exception& fault) {
    return failure(file, fault.what());
  }
}

Result<MapSave> MapWriter::save(const Atlas& atlas) {
  try {
    const bool lesser = !state_->replace && fs::exists(file_) && is_lesser(atlas, state_->held);
    if (lesser && holding_of(atlas).empty()) {
      throw Fault(fmt::format(
          "holds {} keyframes and {} points, and this map has none: it is left as it was",
          state_->held.keyframes.size(), state_->held.points));
    }
    const bool known = state_->database && state_->lock && state_->lock->is_named(file_);
    const MapSave saved = known && !lesser ? save_changes(atlas) : save_whole(atlas, lesser);
    state_->held = holding_of(atlas);
    if (state_->previous && !is_lesser(atlas, *state_->previous)) {
      state_->previous.reset();
      std::error_code ignored;
      fs::remove(previous_of(file_), ignored);
    }
    return saved;
  } catch (const std::exception& fault) {
    // What the file holds now is not known any more; the next save writes all of it.
    state_->database.reset();
    return failure(file_, fault.what());
  }
}

MapSave MapWriter::save_whole(const Atlas& atlas, bool lesser) {
  state_->database.reset();
  if (state_->lock && !state_->lock->is_named(file_)) state_->lock.reset();
  if (fs::exists(file_)) {  // somebody may have put something else there since
    map_format::check_header(file_);
    map_format::recover(file_);
    if (!state_->lock) state_->lock = take_lock(file_, false);
  }
  Result<FreshFile> fresh = FreshFile::make(file_, ".new");
  if (!fresh) throw Fault(fresh.error().message);
  FileLock lock = take_lock(fresh->path(), false);
  std::pair<Written, std::int64_t> written;
  {
    Database database(fresh->path(), Database::Mode::create);
    database.run("BEGIN");
    make_schema(database);
    written = write_atlas(database, atlas, {});
    database.run("COMMIT");
  }
  if (!lock.flush()) throw Fault("cannot be flushed to the disk");
  if (lesser) {
    // One that is of an earlier day is not this writer's to take away.
    const bool mine = state_->previous || !fs::exists(fs::symlink_status(previous_of(file_)));
    if (keep_previous(file_, state_->held) && mine) state_->previous = state_->held;
  }
  if (const Result<void> placed = fresh->place(); !placed) throw Fault(placed.error().message);
  flush_folder(folder_of(file_));
  state_->lock = std::move(lock);
  state_->written = std::move(written.first);
  state_->database.emplace(file_, Database::Mode::write);
  return {true, written.second};
}

MapSave MapWriter::save_changes(const Atlas& atlas) {
  Database& database = *state_->database;
  database.run("BEGIN IMMEDIATE");
  auto [written, rows] = write_atlas(database, atlas, state_->written);
  database.run("COMMIT");
  state_->written = std::move(written);
  return {false, rows};
}

fs::path map_file_target(const fs::path& file) {
  return fs::weakly_canonical(follow_links(fs::absolute(file)));
}

Result<void> save_map(const Atlas& atlas, const fs::path& file, Replacing replacing) {
  Result<MapWriter> writer = MapWriter::open(file, replacing);
  if (!writer) return writer.error();
  if (const Result<MapSave> saved = writer->save(atlas); !saved) return saved.error();
  return {};
}

}  // namespace ydd
