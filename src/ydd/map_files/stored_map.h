// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/map/atlas.h"
#include "ydd/map_files/map_key.h"

namespace ydd {

/// A map file that stays on the disk and is read piece by piece, for maps that are larger than what
/// is needed of them: docs/adr/0013-maps-in-part.md.
///
/// Every row is checked when it is read; whether all are there and of one save, and whether the map
/// fits together, only load_map and check_map know. While it lives, the file is read as it was when
/// it was opened: who saves to the same file meanwhile is refused, who replaces it is not.
/// Failure of every call: one line that names the file. Thread: one call at a time.
class StoredMap {
 public:
  /// Reads what the map is, and nothing of it.
  static Result<StoredMap> open(const std::filesystem::path& file, const MapKey& key = {});

  const std::filesystem::path& file() const;  ///< As it was opened.
  const Camera& camera() const;               ///< That all keyframes were taken with.
  const PyramidScales& scales() const;        ///< Of the extractor's pyramid.
  std::size_t keyframes() const;              ///< How many the file holds.
  std::size_t points() const;                 ///< How many the file holds.
  /// Of the whole map; empty when it has no keyframes.
  KeyFrameId newest_keyframe() const;
  /// Whether it can be read in part: not one of an earlier version, or of another vocabulary.
  bool has_parts() const;

  /// Every keyframe by its words; bags stay in the file (`words`).
  Result<WordIndex> word_index(std::size_t most_postings);
  /// The words of a keyframe. @throws std::runtime_error, one line that names the file, if it has
  /// none or they cannot be read: it is asked in the middle of a query.
  std::shared_ptr<const BagOfWords> words(KeyFrameId keyframe);
  /// With whom a keyframe is covisible. @throws as `words`.
  std::vector<Covisible> neighbours(KeyFrameId keyframe);

  /// So many keyframes at most, nearest to `centres` first by steps along shared points, to parents
  /// and over loops.
  Result<std::vector<KeyFrameId>> neighbourhood(std::span<const KeyFrameId> centres,
                                                std::size_t most);

  /// The part of the map with these keyframes and all points that they see, without pictures, and
  /// with the poses of keyframes that were in an earlier part. What two parts in a row have in
  /// common is read once.
  Result<std::shared_ptr<const Atlas>> part(const std::set<KeyFrameId>& keyframes);

  StoredMap(StoredMap&&) noexcept;
  StoredMap& operator=(StoredMap&&) noexcept;
  ~StoredMap();

 private:
  class Reader;
  explicit StoredMap(std::unique_ptr<Reader> reader);
  std::unique_ptr<Reader> reader_;
};

}  // namespace ydd
