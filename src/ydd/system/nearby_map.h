// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "ydd/base/channel.h"
#include "ydd/base/guard.h"
#include "ydd/base/published.h"
#include "ydd/map_files/stored_map.h"
#include "ydd/system/mapping_runner.h"

namespace ydd {

/// How much of a stored map is in memory.
struct NearbyOptions {
  /// Keyframes at most; about a third of them are always around the camera.
  std::size_t keyframes = 1000;
  /// Places that a lost camera may be in, as the tracker asks (TrackerOptions::place_candidates).
  std::size_t places = 5;
  /// Entries of the index of words, 4 bytes each.
  std::size_t most_postings = 8'000'000;
  /// Loads in a thread of its own; else in the caller's, at once: deterministic.
  bool in_background = true;
};

/// A map that is used and not changed, of which only what is near the camera is in memory; the rest
/// stays in its file. Stands where the mapper would: candidates are refused, the published atlas is
/// the part that is there.
///
/// What was wanted last stays longest. Thread: one caller.
class NearbyMap final : public MappingRunner {
 public:
  /// Reads the index of words and what is around the newest keyframe. Failure: as StoredMap.
  static Result<std::unique_ptr<NearbyMap>> open(StoredMap map, const NearbyOptions& options);
  ~NearbyMap() override;
  NearbyMap(const NearbyMap&) = delete;
  NearbyMap& operator=(const NearbyMap&) = delete;

  /// The camera is where this keyframe is.
  void follow(KeyFrameId reference);
  /// The camera is lost and sees this: the places that look most alike are wanted.
  void look_for(std::shared_ptr<const BagOfWords> words);

  Result<bool> submit(KeyFrameCandidate candidate) override;
  bool idle() const override { return true; }
  void wait_for_frames_before(Timestamp) override {}
  std::shared_ptr<const Atlas> atlas() const override { return atlas_.get(); }
  Result<void> failure() const override { return failure_.get(); }
  Result<void> finish(Ending ending) override;
  MappingReports reports() const override { return {}; }

 private:
  /// A camera that is somewhere, or one that is lost.
  struct Task {
    KeyFrameId reference;
    std::shared_ptr<const BagOfWords> words;
  };

  NearbyMap(StoredMap map, WordIndex index, const NearbyOptions& options);
  void ask(Task task);
  void run() noexcept;
  Result<void> work(const Task& task);
  Result<std::vector<KeyFrameId>> around(KeyFrameId reference);
  Result<std::vector<KeyFrameId>> places_like(const BagOfWords& words);
  Result<void> load(const std::vector<KeyFrameId>& wanted);

  // Of the thread that loads.
  StoredMap map_;
  WordIndex index_;
  const NearbyOptions options_;
  std::vector<KeyFrameId> newest_;                  ///< around the newest keyframe: always there
  std::map<KeyFrameId, std::int64_t> last_wanted_;  ///< of what is loaded: by which task
  std::int64_t tasks_done_ = 0;

  KeyFrameId followed_;  ///< of the caller: asked for last
  FirstError failure_;
  Published<Atlas> atlas_;
  Channel<Task> tasks_{1};
  std::jthread thread_;
};

}  // namespace ydd
