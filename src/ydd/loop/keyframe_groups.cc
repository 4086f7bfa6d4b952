// SPDX-License-Identifier: Apache-2.0
#include "ydd/loop/keyframe_groups.h"

#include <algorithm>
#include <stdexcept>

namespace ydd {
namespace {

constexpr int kNone = -1;

/// The spanning tree by places in the list.
struct Tree {
  std::vector<int> parent;  ///< kNone: a root
  std::vector<int> order;   ///< parents before children
};

Tree tree_of(const Atlas& atlas, const std::vector<KeyFrameId>& keyframes) {
  const auto place_of = [&](KeyFrameId id) {
    const auto found = std::lower_bound(keyframes.begin(), keyframes.end(), id);
    const bool there = found != keyframes.end() && *found == id;
    return there ? static_cast<int>(found - keyframes.begin()) : kNone;
  };
  Tree tree;
  for (const KeyFrameId id : keyframes) {
    tree.parent.push_back(place_of(atlas.at(id).parent));
    if (tree.parent.back() == kNone) tree.order.push_back(place_of(id));
  }
  for (std::size_t at = 0; at < tree.order.size(); ++at) {
    const KeyFrameId id = keyframes[static_cast<std::size_t>(tree.order[at])];
    for (const KeyFrameId child : atlas.at(id).children) {
      if (const int place = place_of(child); place != kNone) tree.order.push_back(place);
    }
  }
  if (tree.order.size() != keyframes.size()) throw std::logic_error("group_keyframes: no tree");
  return tree;
}

/// Cuts the tree into connected pieces of at least `size`, but for those at the roots: a keyframe
/// and what hangs on it are a piece as soon as they are so many (Kundu and Misra, "A linear tree
/// partitioning algorithm", SIAM J. Comput. 1977). True where a piece begins.
std::vector<bool> cuts(const Tree& tree, std::size_t size) {
  std::vector<std::size_t> hanging(tree.parent.size(), 1);
  std::vector<bool> cut(tree.parent.size(), false);
  for (auto at = tree.order.rbegin(); at != tree.order.rend(); ++at) {
    const auto i = static_cast<std::size_t>(*at);
    const int parent = tree.parent[i];
    cut[i] = parent == kNone || hanging[i] >= size;
    if (!cut[i]) hanging[static_cast<std::size_t>(parent)] += hanging[i];
  }
  return cut;
}

}  // namespace

KeyFrameGroups group_keyframes(const Atlas& atlas, const std::vector<KeyFrameId>& keyframes,
                               std::size_t most_groups, std::span<const KeyFrameId> apart) {
  const std::size_t size = (keyframes.size() + most_groups - 1) / most_groups;
  const Tree tree = tree_of(atlas, keyframes);
  const std::vector<bool> cut = cuts(tree, size);
  // The piece of each, by the keyframe that it begins with.
  std::vector<int> begins(keyframes.size(), kNone);
  for (const int i : tree.order) begins[i] = cut[i] ? i : begins[tree.parent[i]];
  std::vector<bool> dissolved(keyframes.size(), size <= 1);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    if (std::find(apart.begin(), apart.end(), keyframes[i]) == apart.end()) continue;
    dissolved[static_cast<std::size_t>(begins[i])] = true;
  }
  KeyFrameGroups out;
  out.group_of.assign(keyframes.size(), kNone);
  out.steps.assign(keyframes.size(), 0);
  for (const int i : tree.order) {
    if (!cut[i] && !dissolved[static_cast<std::size_t>(begins[i])]) {
      out.steps[i] = out.steps[tree.parent[i]] + 1;
    }
  }
  // In the order of the list, so that without grouping a group is a place in it.
  std::vector<int> group_of_piece(keyframes.size(), kNone);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const auto begin = static_cast<std::size_t>(begins[i]);
    const bool alone = dissolved[begin];
    int& group = alone ? out.group_of[i] : group_of_piece[begin];
    if (group == kNone) {
      group = static_cast<int>(out.leader.size());
      out.leader.push_back(alone ? keyframes[i] : keyframes[begin]);
    }
    out.group_of[i] = group;
  }
  return out;
}

}  // namespace ydd
