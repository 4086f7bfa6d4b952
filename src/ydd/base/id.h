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
  std::uint32_t slot = 0;        ///< where in its table
  std::uint32_t generation = 0;  ///< 0: no value at all

  /// Whether it names anything, perhaps something that is no more.
  bool valid() const { return generation != 0; }
  friend auto operator<=>(const Id&, const Id&) = default;
};

struct KeyFrameTag;
struct MapPointTag;
struct MapTag;
using KeyFrameId = Id<KeyFrameTag>;  ///< Names a keyframe of an atlas.
using MapPointId = Id<MapPointTag>;  ///< Names a landmark of an atlas.
using MapId = Id<MapTag>;            ///< Names one of an atlas's maps.

}  // namespace ydd

/// @cond
template <class Tag>
struct std::hash<ydd::Id<Tag>> {
  std::size_t operator()(const ydd::Id<Tag>& id) const noexcept {
    return (static_cast<std::size_t>(id.generation) << 32) ^ id.slot;
  }
};
/// @endcond
