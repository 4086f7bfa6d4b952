// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "ydd/base/id.h"

namespace ydd {

/// A store of values named by ids, with cheap immutable snapshots (copy on write).
///
/// Values live in chunks of 64 behind shared pointers, and these in branches of 64 chunks.
/// `snapshot()` copies the list of branches and starts a new epoch; from then on an edit first
/// clones what older snapshots still see: branch and chunk (64 pointers each) and the value. Epochs
/// decide what is shared, never `use_count()`, which would race with a reader that lets go.
///
/// Thread: one owner calls everything that is not const; a `Table` obtained from `snapshot()` is
/// meant to be used as const and may be read from any thread.
/// Lifetime: a pointer from `find` is valid until the next non-const call on this table (for a
/// snapshot: as long as the snapshot lives). Do not keep it beyond the function.
template <class T, class Tag>
class Table {
 public:
  using IdType = Id<Tag>;  ///< What names its values.

  Table() = default;
  Table(Table&&) noexcept = default;
  Table& operator=(Table&&) noexcept = default;
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;

  /// Stores `value` and gives its id. Slots are reused, last freed first: deterministic.
  IdType insert(T value) {
    std::uint32_t slot = 0;
    if (free_.empty()) {
      slot = slots_++;
      grow_to(slots_);
    } else {
      slot = free_.back();
      free_.pop_back();
    }
    Slot& s = writable_chunk(slot).slots[slot % kChunk];
    s.generation += 1;
    s.epoch = epoch_;
    s.value = std::make_shared<T>(std::move(value));
    ++size_;
    return {slot, s.generation};
  }

  /// The value, or null when the id is stale, foreign or empty.
  const T* find(IdType id) const {
    const Slot* s = slot_of(id);
    return s ? s->value.get() : nullptr;
  }

  /// Whether an id names a value that is still there.
  bool contains(IdType id) const { return find(id) != nullptr; }

  /// The value. @throws std::logic_error on a stale id.
  const T& at(IdType id) const {
    const T* value = find(id);
    if (!value) throw std::logic_error("Table: stale or empty id");
    return *value;
  }

  /// The value, writable, cloned first if a snapshot shares it. @throws std::logic_error on a
  /// stale id.
  T& edit(IdType id) {
    if (!slot_of(id)) throw std::logic_error("Table: edit of a stale or empty id");
    Slot& s = writable_chunk(id.slot).slots[id.slot % kChunk];
    if (s.epoch != epoch_) {
      s.value = std::make_shared<T>(*s.value);
      s.epoch = epoch_;
    }
    return *s.value;
  }

  /// Removes the value. @throws std::logic_error on a stale id.
  void erase(IdType id) {
    if (!slot_of(id)) throw std::logic_error("Table: erase of a stale or empty id");
    writable_chunk(id.slot).slots[id.slot % kChunk].value.reset();
    free_.push_back(id.slot);
    --size_;
  }

  std::size_t size() const { return size_; }  ///< Number of values.
  bool empty() const { return size_ == 0; }   ///< Whether there is no value.
  /// One more than the largest slot ever used: the length for arrays indexed by slot.
  std::uint32_t slots() const { return slots_; }

  /// Calls `visit(id, value)` for every value in slot order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::uint32_t first = 0; first < slots_; first += kChunk) {
      for_each_in(first, std::min(first + kChunk, slots_), visit);
    }
  }

  /// The same for the values in slots [first, end).
  template <class Visit>
  void for_each_in(std::uint32_t first, std::uint32_t end, Visit&& visit) const {
    for (std::uint32_t slot = first; slot < end && slot < slots_; ++slot) {
      const Chunk* const chunk = chunk_of(slot);
      if (!chunk) {
        slot |= kChunk - 1;  // the rest of it is not there either
        continue;
      }
      const Slot& s = chunk->slots[slot % kChunk];
      if (s.value) visit(IdType{slot, s.generation}, static_cast<const T&>(*s.value));
    }
  }

  /// Calls `visit(first, end)` for slots [first, end), 64 of them, in which this table may differ
  /// from `before`, a snapshot of it or the table that it is a snapshot of. All that differs is
  /// visited, in slot order. Costs as much as differs, and O(slots / 4096).
  template <class Visit>
  void for_each_difference(const Table& before, Visit&& visit) const {
    const std::size_t branches = std::max(branches_.size(), before.branches_.size());
    for (std::size_t b = 0; b < branches; ++b) {
      const Branch* const mine = b < branches_.size() ? branches_[b].get() : nullptr;
      const Branch* const other = b < before.branches_.size() ? before.branches_[b].get() : nullptr;
      if (mine == other) continue;
      for (std::uint32_t c = 0; c < kBranch; ++c) {
        if ((mine ? mine->chunks[c].get() : nullptr) ==
            (other ? other->chunks[c].get() : nullptr)) {
          continue;
        }
        const auto first = static_cast<std::uint32_t>((b * kBranch + c) * kChunk);
        visit(first, first + kChunk);
      }
    }
  }

  /// All ids in slot order.
  std::vector<IdType> ids() const {
    std::vector<IdType> out;
    out.reserve(size_);
    for_each([&](IdType id, const T&) { out.push_back(id); });
    return out;
  }

  /// Ids that freed slots had last, in the order in which they were freed: the last is reused
  /// first.
  std::vector<IdType> freed() const {
    std::vector<IdType> out;
    out.reserve(free_.size());
    for (const std::uint32_t slot : free_) {
      out.push_back({slot, chunk_of(slot)->slots[slot % kChunk].generation});
    }
    return out;
  }

  /// A table that gives and finds the same ids as the one that had these values and freed slots.
  /// Nothing unless the slots of both together are 0, 1, ... without gap and every id is valid.
  static std::optional<Table> restore(std::vector<std::pair<IdType, T>> values,
                                      const std::vector<IdType>& freed) {
    Table table;
    table.slots_ = static_cast<std::uint32_t>(values.size() + freed.size());
    for (std::uint32_t slots = 0; slots < table.slots_;) {
      slots = std::min(slots + kChunk, table.slots_);
      table.grow_to(slots);
    }
    const auto claim = [&](IdType id) -> Slot* {
      if (!id.valid() || id.slot >= table.slots_) return nullptr;
      Slot& s = table.writable_chunk(id.slot).slots[id.slot % kChunk];
      if (s.generation != 0) return nullptr;  // named twice
      s.generation = id.generation;
      s.epoch = table.epoch_;
      return &s;
    };
    for (auto& [id, value] : values) {
      Slot* const s = claim(id);
      if (!s) return std::nullopt;
      s->value = std::make_shared<T>(std::move(value));
    }
    for (const IdType id : freed) {
      if (!claim(id)) return std::nullopt;
      table.free_.push_back(id.slot);
    }
    table.size_ = values.size();
    return table;
  }

  /// A table of `slots` slots in which only these values are; the ids of others find nothing, as if
  /// they had been erased. Costs memory for what is there, and a pointer for each 4,096 slots.
  /// Nothing when an id is not valid, beyond the last slot or given twice.
  static std::optional<Table> of_part(std::vector<std::pair<IdType, T>> values,
                                      std::uint32_t slots) {
    Table table;
    table.slots_ = slots;
    table.size_ = values.size();
    const auto nothing = std::make_shared<Branch>(0);  // of an earlier epoch: cloned when written
    table.branches_.assign((slots + kChunk * kBranch - 1) / (kChunk * kBranch), nothing);
    for (auto& [id, value] : values) {
      if (!id.valid() || id.slot >= slots) return std::nullopt;
      Slot& s = table.writable_chunk(id.slot).slots[id.slot % kChunk];
      if (s.value) return std::nullopt;
      s.generation = id.generation;
      s.epoch = table.epoch_;
      s.value = std::make_shared<T>(std::move(value));
    }
    return table;
  }

  /// An immutable copy that later edits of this table do not touch. O(slots / 4096).
  Table snapshot() {
    Table copy;
    copy.branches_ = branches_;
    copy.free_ = free_;
    copy.slots_ = slots_;
    copy.size_ = size_;
    copy.epoch_ = ++epoch_;  // values written before are now shared with the copy
    ++epoch_;                // and the copy, should it ever be edited, owns nothing of ours
    return copy;
  }

  /// A copy of a snapshot to be edited by whoever asks, in any thread: what neither changes is
  /// shared. O(slots / 4096).
  Table fork() const {
    Table copy;
    copy.branches_ = branches_;
    copy.free_ = free_;
    copy.slots_ = slots_;
    copy.size_ = size_;
    copy.epoch_ = epoch_;  // of this snapshot: its own values are all older, and so not owned
    return copy;
  }

  /// Takes over the edits that were made on a fork of an earlier snapshot of this table: wherever
  /// this still has the value that `before`, the snapshot, has, it gets that of `after`, the fork,
  /// in which nothing may have been inserted or erased. Calls `visit(id)` for all others that are
  /// here: edited or inserted meanwhile. Costs as much as has been edited meanwhile, and
  /// O(slots / 4096).
  template <class Visit>
  void adopt(const Table& before, const Table& after, Visit&& visit) {
    for (std::size_t b = 0; b < branches_.size(); ++b) {
      const Branch* const old = b < before.branches_.size() ? before.branches_[b].get() : nullptr;
      if (branches_[b].get() == old) {
        branches_[b] = after.branches_[b];
        continue;
      }
      const auto first = static_cast<std::uint32_t>(b * kBranch * kChunk);
      Branch& branch = writable_branch(first);
      for (std::uint32_t c = 0; c < kBranch; ++c) {
        if (!branch.chunks[c]) continue;
        if (old && branch.chunks[c] == old->chunks[c]) {
          branch.chunks[c] = after.branches_[b]->chunks[c];
        } else {
          adopt_chunk(first + c * kChunk, old ? old->chunks[c].get() : nullptr,
                      old ? after.branches_[b]->chunks[c].get() : nullptr, visit);
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t kChunk = 64;   ///< slots
  static constexpr std::uint32_t kBranch = 64;  ///< chunks
  struct Slot {
    std::shared_ptr<T> value;
    std::uint32_t generation = 0;
    std::uint64_t epoch = 0;
  };
  struct Chunk {
    explicit Chunk(std::uint64_t e) : epoch(e) {}
    std::array<Slot, kChunk> slots;
    std::uint64_t epoch;
  };

  struct Branch {
    explicit Branch(std::uint64_t e) : epoch(e) {}
    std::array<std::shared_ptr<Chunk>, kBranch> chunks;  ///< null: none of its slots is used
    std::uint64_t epoch;
  };

  /// Of a slot below `slots_`; null in a part of a table where nothing is.
  const Chunk* chunk_of(std::uint32_t slot) const {
    return branches_[slot / (kChunk * kBranch)]->chunks[slot / kChunk % kBranch].get();
  }

  const Slot* slot_of(IdType id) const {
    if (!id.valid() || id.slot >= slots_) return nullptr;
    const Chunk* const chunk = chunk_of(id.slot);
    if (!chunk) return nullptr;
    const Slot& s = chunk->slots[id.slot % kChunk];
    return s.generation == id.generation && s.value ? &s : nullptr;
  }

  /// Makes room for the chunk of the last of so many slots; that of the one before is there.
  void grow_to(std::uint32_t slots) {
    const std::uint32_t last = slots - 1;
    if (last / (kChunk * kBranch) == branches_.size()) {
      branches_.push_back(std::make_shared<Branch>(epoch_));
    }
    std::shared_ptr<Chunk>& chunk = writable_branch(last).chunks[last / kChunk % kBranch];
    if (!chunk) chunk = std::make_shared<Chunk>(epoch_);
  }

  Branch& writable_branch(std::uint32_t slot) {
    std::shared_ptr<Branch>& branch = branches_[slot / (kChunk * kBranch)];
    if (branch->epoch != epoch_) {
      branch = std::make_shared<Branch>(*branch);
      branch->epoch = epoch_;
    }
    return *branch;
  }

  Chunk& writable_chunk(std::uint32_t slot) {
    std::shared_ptr<Chunk>& chunk = writable_branch(slot).chunks[slot / kChunk % kBranch];
    if (!chunk) {
      chunk = std::make_shared<Chunk>(epoch_);
    } else if (chunk->epoch != epoch_) {
      chunk = std::make_shared<Chunk>(*chunk);
      chunk->epoch = epoch_;
    }
    return *chunk;
  }

  template <class Visit>
  void adopt_chunk(std::uint32_t first, const Chunk* before, const Chunk* after, Visit&& visit) {
    Chunk& mine = writable_chunk(first);
    for (std::uint32_t i = 0; i < kChunk; ++i) {
      Slot& s = mine.slots[i];
      if (!s.value) continue;
      if (before && after && before->slots[i].value == s.value) {
        s = after->slots[i];
      } else {
        visit(IdType{first + i, s.generation});
      }
    }
  }

  std::vector<std::shared_ptr<Branch>> branches_;
  std::vector<std::uint32_t> free_;
  std::uint32_t slots_ = 0;
  std::size_t size_ = 0;
  std::uint64_t epoch_ = 1;
};

}  // namespace ydd
