// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace ydd {

/// A name for a value in a Table<T>. Ids of different tags cannot be mixed; an id whose value was
/// erased never finds the slot's next tenant, because generations differ.
template <class Tag>
struct Id {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;  ///< 0: no value at all

  bool valid() const { return generation != 0; }
  friend auto operator<=>(const Id&, const Id&) = default;
};

struct KeyFrameTag;
struct MapPointTag;
struct MapTag;
using KeyFrameId = Id<KeyFrameTag>;
using MapPointId = Id<MapPointTag>;
using MapId = Id<MapTag>;

}  // namespace ydd

template <class Tag>
struct std::hash<ydd::Id<Tag>> {
  std::size_t operator()(const ydd::Id<Tag>& id) const noexcept {
    return (static_cast<std::size_t>(id.generation) << 32) ^ id.slot;
  }
};
