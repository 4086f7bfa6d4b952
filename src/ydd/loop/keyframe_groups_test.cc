// SPDX-License-Identifier: Apache-2.0
#include "ydd/loop/keyframe_groups.h"

#include <map>

#include <gtest/gtest.h>

namespace ydd {
namespace {

/// A tree of keyframes that have nothing but parents: a chain with a twig at every third.
Atlas tree_of(int chain) {
  Atlas atlas(Camera(), PyramidScales::make(8, 1.2));
  const MapId map = atlas.new_map();
  const auto add = [&](KeyFrameId parent) {
    KeyFrame keyframe;
    keyframe.map = map;
    keyframe.shared_features = std::make_shared<const Features>();
    keyframe.parent = parent;
    return atlas.add_keyframe(std::move(keyframe));
  };
  KeyFrameId last;
  for (int i = 0; i < chain; ++i) {
    last = add(last);
    if (i % 3 == 0) add(last);
  }
  return atlas;
}

TEST(GroupKeyframes, FewAreGroupsOfTheirOwnInTheirOrder) {
  const Atlas atlas = tree_of(20);
  const std::vector<KeyFrameId> ids = atlas.keyframes().ids();
  const KeyFrameGroups groups = group_keyframes(atlas, ids, ids.size(), {});
  EXPECT_EQ(groups.leader, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(groups.group_of[i], static_cast<int>(i));
}

TEST(GroupKeyframes, ManyAreConnectedGroupsOfAboutEqualSize) {
  const Atlas atlas = tree_of(3000);
  const std::vector<KeyFrameId> ids = atlas.keyframes().ids();  // 4000
  const KeyFrameGroups groups = group_keyframes(atlas, ids, 100, {});
  EXPECT_GE(groups.leader.size(), 60U);
  EXPECT_LE(groups.leader.size(), 101U);
  std::map<int, int> sizes;
  std::map<KeyFrameId, int> group;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    ++sizes[groups.group_of[i]];
    group[ids[i]] = groups.group_of[i];
  }
  EXPECT_EQ(sizes.size(), groups.leader.size());
  for (const auto& [g, size] : sizes) EXPECT_LE(size, 2 * 40 + 2);
  // From each the way to its leader stays within the group.
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const KeyFrameId leader = groups.leader[static_cast<std::size_t>(groups.group_of[i])];
    int steps = 0;
    for (KeyFrameId id = ids[i]; id != leader; id = atlas.at(id).parent) {
      ++steps;
      ASSERT_TRUE(id.valid());
      EXPECT_EQ(group[id], groups.group_of[i]);
    }
    EXPECT_EQ(groups.steps[i], steps);
  }
}

TEST(GroupKeyframes, ThoseThatStandApartDissolveTheirGroups) {
  const Atlas atlas = tree_of(300);
  const std::vector<KeyFrameId> ids = atlas.keyframes().ids();
  const KeyFrameId apart[] = {ids[150]};
  const KeyFrameGroups groups = group_keyframes(atlas, ids, 20, apart);
  const auto own = static_cast<std::size_t>(groups.group_of[150]);
  EXPECT_EQ(groups.leader[own], ids[150]);
  int alone = 0;
  for (const int group : groups.group_of) {
    alone += std::count(groups.group_of.begin(), groups.group_of.end(), group) == 1 ? 1 : 0;
  }
  EXPECT_GE(alone, 20);
  EXPECT_LE(alone, 60);
}

}  // namespace
}  // namespace ydd
