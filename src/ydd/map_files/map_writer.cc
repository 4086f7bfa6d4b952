// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ydd/base/file_lock.h"
#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_header.h"
#include "ydd/map_files/map_rows.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using map_format::Database;
using map_format::Fault;
using map_format::HeldRows;

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
  std::size_t keyframes = 0, points = 0;
  std::shared_ptr<const Atlas> atlas;                    ///< null: only the stamps are known
  std::vector<std::pair<KeyFrameId, Timestamp>> stamps;  ///< of the keyframes

  bool empty() const { return keyframes == 0 || points == 0; }
};

Holding holding_of(const Atlas& atlas) {
  Holding holding{atlas.keyframes().size(), atlas.points().size(), nullptr, {}};
  holding.stamps.reserve(holding.keyframes);
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    holding.stamps.emplace_back(id, keyframe.stamp);
  });
  return holding;
}

Holding holding_of(const std::shared_ptr<const Atlas>& atlas) {
  return {atlas->keyframes().size(), atlas->points().size(), atlas, {}};
}

/// Whether each keyframe of `old` is in the atlas, or was culled from it.
bool goes_on_from(const Holding& old, const Atlas& atlas) {
  const auto has = [&](KeyFrameId id, Timestamp stamp) {
    const KeyFrame* const keyframe = atlas.find(id);
    return keyframe ? keyframe->stamp == stamp : atlas.culled().contains(id);
  };
  if (!old.atlas) {
    return std::ranges::all_of(old.stamps,
                               [&](const auto& entry) { return has(entry.first, entry.second); });
  }
  bool all = true;
  const auto& before = old.atlas->keyframes();
  atlas.keyframes().for_each_difference(before, [&](std::uint32_t first, std::uint32_t end) {
    before.for_each_in(first, end, [&](KeyFrameId id, const KeyFrame& keyframe) {
      all = all && has(id, keyframe.stamp);
    });
  });
  return all;
}

/// A map that goes on may lose what has become redundant, but not most of itself.
bool is_lesser(const Atlas& atlas, const Holding& old) {
  const auto keyframes = static_cast<double>(atlas.keyframes().size());
  const auto points = static_cast<double>(atlas.points().size());
  const auto below = [&](double share) {
    return keyframes < share * static_cast<double>(old.keyframes) ||
           points < share * static_cast<double>(old.points);
  };
  return below(0.5) || (below(1.0) && !goes_on_from(old, atlas));
}

fs::path previous_of(const fs::path& file) { return file.string() + ".previous"; }

/// Gives the file a second name, so that it stays when the first is given to another; true if it
/// has it now. A larger map that has that name already keeps it.
bool keep_previous(const fs::path& file, const Holding& old, const MapKey& key) {
  const fs::path previous = previous_of(file);
  if (fs::exists(fs::symlink_status(previous))) {
    const Result<Atlas> before = load_map(previous, key);
    if (!before) {
      throw Fault(fmt::format("its map cannot be kept as {}, as something else is there; move it",
                              previous.string()));
    }
    if (!is_lesser(*before, old)) {
      log::warning("{}: a lesser map replaces another one ({} keyframes, {} points); {} stays",
                   file.string(), old.keyframes, old.points, previous.string());
      return false;
    }
    fs::remove(previous);
  }
  std::error_code no_second_names;
  fs::create_hard_link(file, previous, no_second_names);
  if (no_second_names) fs::copy_file(file, previous);
  log::warning("{}: the map of before ({} keyframes, {} points) holds more; it is kept as {}",
               file.string(), old.keyframes, old.points, previous.string());
  return true;
}

Error failure(const fs::path& file, const char* reason) {
  const std::string_view text = reason;
  const bool named = text.starts_with(file.string());
  return named ? Error{std::string(text)} : Error{fmt::format("{}: {}", file.string(), text)};
}

}  // namespace

struct MapWriter::State {
  MapKey key;
  std::optional<FileLock> lock;  ///< of the file that is there; outlives the connection
  std::optional<Database> database;
  HeldRows rows;  ///< of the file; none: not known
  Holding held;   ///< by the file
  bool replace = false;
  std::optional<Holding> previous;  ///< what was set aside for as long as there is less

  /// Whether rows of the file at `file` can be changed into those of the atlas: it is the one that
  /// was read or written last, and the atlas goes on from what it holds.
  bool can_change(const fs::path& file, const Atlas& atlas) const {
    if (rows.empty() || !lock || !lock->is_named(file)) return false;
    return database || goes_on_from(held, atlas);
  }
};

MapWriter::MapWriter(fs::path file, std::unique_ptr<State> state)
    : file_(std::move(file)), state_(std::move(state)) {}
MapWriter::MapWriter(MapWriter&&) noexcept = default;
MapWriter& MapWriter::operator=(MapWriter&&) noexcept = default;
MapWriter::~MapWriter() = default;

Result<MapWriter> MapWriter::open(const fs::path& file, Replacing replacing, const MapKey& key) {
  try {
    // A link stays a link: what it leads to is replaced. Absolute first: the canonical path of a
    // file that is not there yet would stay relative.
    const fs::path target = map_file_target(file);
    auto state = std::make_unique<State>();
    state->replace = replacing == Replacing::anything;
    state->key = key;
    if (key) (void)map_format::cipher_sqlite();  // now, not at the end of a run
    if (::access(folder_of(target).c_str(), W_OK | X_OK) != 0) {
      throw Fault("its folder is not there, or cannot be written to");
    }
    if (fs::exists(target)) {
      map_format::check_header(target, key);
      map_format::recover(target, key);
      state->lock = take_lock(target, false);
      map_format::ReadMap read = map_format::read_rows(target, key);
      state->held = holding_of(read.atlas);
      // Rows of an earlier version are not gone on with: the first save writes all anew.
      if (read.version == map_format::kVersion) state->rows = std::move(read.rows);
    }
    return MapWriter(target, std::move(state));
  } catch (const std::exception& fault) {
    return failure(file, fault.what());
  }
}

Result<MapSave> MapWriter::save(const Atlas& atlas) {
  Result<MapSave> saved = save_after(atlas, nullptr);
  if (saved) state_->held = holding_of(atlas);
  return saved;
}

Result<MapSave> MapWriter::save(const std::shared_ptr<const Atlas>& atlas) {
  // What the file holds shares with this one what has not changed.
  Result<MapSave> saved = save_after(*atlas, state_->database ? state_->held.atlas : nullptr);
  if (saved) state_->held = holding_of(atlas);
  return saved;
}

Result<MapSave> MapWriter::save_after(const Atlas& atlas, std::shared_ptr<const Atlas> before) {
  try {
    const bool lesser = !state_->replace && fs::exists(file_) && is_lesser(atlas, state_->held);
    if (lesser && (atlas.keyframes().empty() || atlas.points().empty())) {
      throw Fault(fmt::format(
          "holds {} keyframes and {} points, and this map has none: it is left as it was",
          state_->held.keyframes, state_->held.points));
    }
    const bool change = !lesser && state_->can_change(file_, atlas);
    const MapSave saved = change ? save_changes(atlas, before.get()) : save_whole(atlas, lesser);
    if (state_->previous && !is_lesser(atlas, *state_->previous)) {
      state_->previous.reset();
      std::error_code ignored;
      fs::remove(previous_of(file_), ignored);
    }
    return saved;
  } catch (const std::exception& fault) {
    // What the file holds now is not known any more; the next save writes all of it.
    state_->database.reset();
    state_->rows.clear();
    return failure(file_, fault.what());
  }
}

MapSave MapWriter::save_whole(const Atlas& atlas, bool lesser) {
  state_->database.reset();
  if (state_->lock && !state_->lock->is_named(file_)) state_->lock.reset();
  if (fs::exists(file_)) {  // somebody may have put something else there since
    map_format::check_header(file_, state_->key);
    map_format::recover(file_, state_->key);
    if (!state_->lock) state_->lock = take_lock(file_, false);
  }
  Result<FreshFile> fresh = FreshFile::make(file_, ".new");
  if (!fresh) throw Fault(fresh.error().message);
  FileLock lock = take_lock(fresh->path(), false);
  state_->rows.clear();
  std::int64_t rows = 0;
  {
    Database database(fresh->path(), Database::Mode::create, state_->key);
    database.run("BEGIN");
    map_format::make_schema(database);
    rows = map_format::write_rows(database, atlas, nullptr, state_->rows);
    database.run("COMMIT");
  }
  if (!lock.flush()) throw Fault("cannot be flushed to the disk");
  if (lesser) {
    // One that is of an earlier day is not this writer's to take away.
    const bool mine = state_->previous || !fs::exists(fs::symlink_status(previous_of(file_)));
    if (keep_previous(file_, state_->held, state_->key) && mine) state_->previous = state_->held;
  }
  if (const Result<void> placed = fresh->place(); !placed) throw Fault(placed.error().message);
  flush_folder(folder_of(file_));
  state_->lock = std::move(lock);
  state_->database.emplace(file_, Database::Mode::write, state_->key);
  return {true, rows};
}

MapSave MapWriter::save_changes(const Atlas& atlas, const Atlas* before) {
  if (!state_->database) state_->database.emplace(file_, Database::Mode::write, state_->key);
  Database& database = *state_->database;
  database.run("BEGIN IMMEDIATE");
  const std::int64_t rows = map_format::write_rows(database, atlas, before, state_->rows);
  database.run("COMMIT");
  return {false, rows};
}

fs::path map_file_target(const fs::path& file) {
  return fs::weakly_canonical(follow_links(fs::absolute(file)));
}

Result<void> save_map(const Atlas& atlas, const fs::path& file, Replacing replacing,
                      const MapKey& key) {
  Result<MapWriter> writer = MapWriter::open(file, replacing, key);
  if (!writer) return writer.error();
  if (const Result<MapSave> saved = writer->save(atlas); !saved) return saved.error();
  return {};
}

}  // namespace ydd
