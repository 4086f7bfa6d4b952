// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/file_lock.h"
#include "ydd/base/version.h"
#include "ydd/map/map_blobs.h"
#include "ydd/map/map_bytes.h"
#include "ydd/map/map_file.h"
#include "ydd/map/map_header.h"
#include "ydd/map/map_schema.h"

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
  if (!sink.keep(map_format::kFeatures, id.slot, k.observations)) {
    sink.put(map_format::kFeatures,
             {id.slot, {whole(id.generation), map_format::encode_features(k.features())}},
             k.observations);
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
  for (const auto& [id, culled] : atlas.culled()) {
    const std::uint64_t key = static_cast<std::uint64_t>(id.generation) << 32U | id.slot;
    sink.put(map_format::kCulled, {whole(key),
                                   {whole(culled.parent.slot), whole(culled.parent.generation),
                                    map_format::encode_pose(culled.T_parent_keyframe)}});
  }
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
};

MapWriter::MapWriter(fs::path file, std::unique_ptr<State> state)
    : file_(std::move(file)), state_(std::move(state)) {}
MapWriter::MapWriter(MapWriter&&) noexcept = default;
MapWriter& MapWriter::operator=(MapWriter&&) noexcept = default;
MapWriter::~MapWriter() = default;

Result<MapWriter> MapWriter::open(const fs::path& file) {
  try {
    // A link stays a link: what it leads to is replaced. Absolute first: the canonical path of a
    // file that is not there yet would stay relative.
    const fs::path target = fs::weakly_canonical(fs::absolute(file));
    auto state = std::make_unique<State>();
    if (::access(folder_of(target).c_str(), W_OK | X_OK) != 0) {
      throw Fault("its folder is not there, or cannot be written to");
    }
    if (fs::exists(target)) {
      map_format::check_header(target);
      map_format::recover(target);
      state->lock = take_lock(target, false);
      if (const Result<Atlas> held = load_map(target); !held) throw Fault(held.error().message);
    }
    return MapWriter(target, std::move(state));
  } catch (const std::exception& fault) {
    return failure(file, fault.what());
  }
}

Result<MapSave> MapWriter::save(const Atlas& atlas) {
  try {
    const bool known = state_->database && state_->lock && state_->lock->is_named(file_);
    return known ? save_changes(atlas) : save_whole(atlas);
  } catch (const std::exception& fault) {
    // What the file holds now is not known any more; the next save writes all of it.
    state_->database.reset();
    return failure(file_, fault.what());
  }
}

MapSave MapWriter::save_whole(const Atlas& atlas) {
  const fs::path fresh = file_.string() + ".new";
  state_->database.reset();
  if (state_->lock && !state_->lock->is_named(file_)) state_->lock.reset();
  if (fs::exists(file_)) {  // somebody may have put something else there since
    map_format::check_header(file_);
    map_format::recover(file_);
    if (!state_->lock) state_->lock = take_lock(file_, false);
  }
  FileLock lock = take_lock(fresh, true);
  std::pair<Written, std::int64_t> written;
  try {
    if (!lock.truncate()) throw Fault("cannot be written");
    Database database(fresh, Database::Mode::create);
    database.run("BEGIN");
    make_schema(database);
    written = write_atlas(database, atlas, {});
    database.run("COMMIT");
  } catch (...) {
    fs::remove(fresh);
    throw;
  }
  if (!lock.flush()) throw Fault("cannot be flushed to the disk");
  fs::rename(fresh, file_);
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

Result<void> save_map(const Atlas& atlas, const fs::path& file) {
  Result<MapWriter> writer = MapWriter::open(file);
  if (!writer) return writer.error();
  if (const Result<MapSave> saved = writer->save(atlas); !saved) return saved.error();
  return {};
}

}  // namespace ydd
