// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ydd/base/timestamp.h"

namespace ydd {

/// What belongs together in two lists: an index into each.
struct IndexPair {
  std::size_t a = 0;
  std::size_t b = 0;
  friend bool operator==(const IndexPair&, const IndexPair&) = default;
};

/// One-to-one pairs of stamps less than `max_difference_s` apart, closest pairs first taken
/// (greedily, ties by the earlier `a`, then the earlier `b`), in the order of `a`: what the TUM
/// RGB-D benchmark does for images and for trajectories.
/// @throws std::logic_error unless both lists are strictly increasing.
std::vector<IndexPair> associate(std::span<const Timestamp> a, std::span<const Timestamp> b,
                                 double max_difference_s);

/// Index of the stamp nearest to `stamp`, the earlier of two equally near. `stamps` is sorted and
/// not empty.
std::size_t nearest_index(std::span<const Timestamp> stamps, Timestamp stamp);

}  // namespace ydd
