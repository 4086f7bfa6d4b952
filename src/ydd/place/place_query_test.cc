// SPDX-License-Identifier: Apache-2.0
#include "ydd/place/place_query.h"

#include <gtest/gtest.h>

#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using namespace testing_world;  // NOLINT(google-build-using-namespace)

BagOfWords words_of(const View& view) {
  return bag_of_words(builtin_vocabulary(), view.features().descriptors);
}

TEST(QueryPlaces, TheSamePlaceComesFirstAndTheFilterHolds) {
  std::vector<PointWorld> places;
  for (unsigned seed = 1; seed <= 8; ++seed) places.push_back(make_world(500, seed));
  Atlas atlas(places[0].camera, places[0].scales);
  std::vector<KeyFrameId> ids;
  for (const PointWorld& place : places) {
    const View view = look(place, SE3());
    KeyFrame keyframe = keyframe_of(view);
    keyframe.map = atlas.new_map();
    keyframe.words = std::make_shared<const BagOfWords>(words_of(view));
    ids.push_back(atlas.add_keyframe(std::move(keyframe)));
  }
  ViewOptions again;
  again.flipped_bits = 15;
  again.seed = 77;
  const BagOfWords query = words_of(look(places[5], hand_held(0.3), again));
  const auto all = query_places(
      atlas, query, [](KeyFrameId) { return true; }, 3);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].keyframe, ids[5]);
  EXPECT_GT(all[0].score, 1.5 * all[1].score);
  const auto others = query_places(
      atlas, query, [&](KeyFrameId id) { return id != ids[5]; }, 3);
  for (const PlaceCandidate& c : others) EXPECT_NE(c.keyframe, ids[5]);
}

}  // namespace
}  // namespace ydd
