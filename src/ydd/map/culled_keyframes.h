// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "ydd/map/map_types.h"

namespace ydd {

/// The keyframes that a map no longer keeps. They only ever grow in number, a snapshot of them is
/// taken with each of the map, and a long walk culls most of what it creates: a copy costs a
/// pointer for each 64 slots, and adding one copies what its 64 slots hold. Thread: a copy may be
/// read from any thread.
class CulledKeyFrames {
 public:
  CulledKeyFrames() = default;
  explicit CulledKeyFrames(const std::map<KeyFrameId, CulledKeyFrame>& all) {
    for (const auto& [id, culled] : all) add(id, culled);
  }

  void add(KeyFrameId id, const CulledKeyFrame& culled) {
    const std::size_t at = id.slot / kChunk;
    if (at >= chunks_.size()) chunks_.resize(at + 1);
    auto chunk = chunks_[at] ? std::make_shared<Chunk>(*chunks_[at]) : std::make_shared<Chunk>();
    size_ += chunk->insert_or_assign(id, culled).second ? 1 : 0;
    chunks_[at] = std::move(chunk);
  }

  /// Null when that keyframe was not culled. Valid as long as this object, or until `add`.
  const CulledKeyFrame* find(KeyFrameId id) const {
    const std::size_t at = id.slot / kChunk;
    if (at >= chunks_.size() || !chunks_[at]) return nullptr;
    const auto found = chunks_[at]->find(id);
    return found == chunks_[at]->end() ? nullptr : &found->second;
  }
  bool contains(KeyFrameId id) const { return find(id) != nullptr; }
  std::size_t size() const { return size_; }

  /// Calls `visit(id, culled)` in the order of the ids.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& chunk : chunks_) {
      if (!chunk) continue;
      for (const auto& [id, culled] : *chunk) visit(id, culled);
    }
  }

  /// Calls `visit(id, culled)` for those that may differ from `before`, an earlier or later copy or
  /// another one; all that differ or that `before` does not have are visited, in the order of the
  /// ids. Costs as much as differs, and O(slots / 64).
  template <class Visit>
  void for_each_difference(const CulledKeyFrames& before, Visit&& visit) const {
    for (std::size_t at = 0; at < chunks_.size(); ++at) {
      if (!chunks_[at] || (at < before.chunks_.size() && chunks_[at] == before.chunks_[at])) {
        continue;
      }
      for (const auto& [id, culled] : *chunks_[at]) visit(id, culled);
    }
  }

 private:
  static constexpr std::uint32_t kChunk = 64;
  using Chunk = std::map<KeyFrameId, CulledKeyFrame>;

  std::vector<std::shared_ptr<const Chunk>> chunks_;  ///< by slot; null: none yet
  std::size_t size_ = 0;
};

}  // namespace ydd
