// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ydd/map/atlas.h"

namespace ydd {

/// Keyframes of a map in groups that hang together in the spanning tree, for problems in which
/// neighbours may move as one.
struct KeyFrameGroups {
  std::vector<int> group_of;       ///< by place in the list of keyframes
  std::vector<int> steps;          ///< likewise: up the tree to the leader of the group
  std::vector<KeyFrameId> leader;  ///< of each group: the one nearest to the root of the tree
};

/// Groups of about equal size, not many more than `most_groups` of them; with so few keyframes,
/// each is a group of its own. So is each that shares its group with one of `apart`. `keyframes`:
/// all of a map, in the order of their ids. Deterministic.
KeyFrameGroups group_keyframes(const Atlas& atlas, const std::vector<KeyFrameId>& keyframes,
                               std::size_t most_groups, std::span<const KeyFrameId> apart);

}  // namespace ydd
