// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/map/atlas.h"
#include "ydd/map_files/map_key.h"

/// An atlas in one SQLite file: docs/maps.md has the format, docs/adr/0006-map-files.md the
/// reasons.
namespace ydd {

/// The atlas in a map file, equal to the one that was saved down to its ids and the ids it will
/// give next; bags of words and grids are made anew, points that were rejected are not stored.
///
/// Failure: one line that names the file and says whether it is foreign, cut short, from a newer
/// version or damaged. The file is never changed, except that a save which was killed half-way is
/// rolled back by what SQLite left beside it.
///
/// With a key the file must be encrypted by it, without one plain; so in all functions below.
/// Failure also: it is not, or SQLCipher is missing.
Result<Atlas> load_map(const std::filesystem::path& file, const MapKey& key = {});

/// What a look at a map file found.
struct MapCheck {
  std::size_t keyframes = 0, points = 0, maps = 0;  ///< of a sound one
  std::vector<std::string> faults;                  ///< a line each, without the name; none: sound
};

/// Looks at everything: header, pages of the database, tables, the checksum of every row, their
/// sum, and whether the atlas fits together (the first thing that does not, and only where all rows
/// are right). Repairs nothing.
MapCheck check_map(const std::filesystem::path& file, const MapKey& key = {});

/// What a save did.
struct MapSave {
  bool whole = false;     ///< a new file that replaced the old one; else changed rows only
  std::int64_t rows = 0;  ///< written or deleted
};

/// What a save may do to a map that holds more than the new one.
enum class Replacing {
  lesser,    ///< it is kept beside as FILE.previous, or the save is refused if the new one is empty
  anything,  ///< it is lost, as the user wishes
};

/// Saves an atlas again and again to one file.
///
/// A first save that does not go on from the map in the file writes a new file beside it and
/// renames it. One that does (each keyframe of the file is in the map, or was culled from it) and
/// all later ones change the rows that have changed, in one transaction. Whatever is killed, the
/// file holds one complete save. A map is never replaced by a lesser one (fewer keyframes or
/// points; of a map that it goes on from, fewer than half) in silence: FILE.previous is the one
/// before until the new one holds as much. Thread: one call at a time. While it lives, the file is
/// claimed: a second writer is refused.
class MapWriter {
 public:
  /// Does not write yet. Failure: what is there is no map file, is damaged, is from a newer
  /// version, or is being written by another process; or the folder cannot be written to.
  static Result<MapWriter> open(const std::filesystem::path& file,
                                Replacing replacing = Replacing::lesser, const MapKey& key = {});

  /// After a failure the file holds what it held before. Costs as much as has changed since the
  /// snapshot that was saved before, and keeps this one; the first save looks at all of it.
  Result<MapSave> save(const std::shared_ptr<const Atlas>& atlas);
  /// The same for a map that goes on changing: looks at all of it.
  Result<MapSave> save(const Atlas& atlas);

  /// Where it writes, as it was given.
  const std::filesystem::path& file() const { return file_; }

  MapWriter(MapWriter&&) noexcept;
  MapWriter& operator=(MapWriter&&) noexcept;
  ~MapWriter();

 private:
  struct State;
  MapWriter(std::filesystem::path file, std::unique_ptr<State> state);
  Result<MapSave> save_after(const Atlas& atlas, std::shared_ptr<const Atlas> before);
  MapSave save_whole(const Atlas& atlas, bool lesser);
  MapSave save_changes(const Atlas& atlas, const Atlas* before);

  std::filesystem::path file_;
  std::unique_ptr<State> state_;
};

/// Saves once.
Result<void> save_map(const Atlas& atlas, const std::filesystem::path& file,
                      Replacing replacing = Replacing::lesser, const MapKey& key = {});

/// Writes the map in `file` to `out`, which has a key of its own; an empty one makes
/// it plain. They may be the same file, which then is the old one or the whole new one at any time.
/// Failure: as load_map; or there is another file at `out`, or somebody is writing.
Result<void> convert_map(const std::filesystem::path& file, const MapKey& key,
                         const std::filesystem::path& out, const MapKey& out_key);

/// The file that a save to `file` writes: a link stays, what it leads to is replaced.
std::filesystem::path map_file_target(const std::filesystem::path& file);

}  // namespace ydd
