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
  ASSERT_EQ(others.size(), 3U);
  for (const PlaceCandidate& c : others) EXPECT_NE(c.keyframe, ids[5]);
  for (const PlaceCandidate& c : all) {
    EXPECT_NEAR(c.score, similarity(query, *atlas.at(c.keyframe).words), 1e-5);
  }
  EXPECT_EQ(query_places(
                atlas, BagOfWords{}, [](KeyFrameId) { return true; }, 3)[0]
                .score,
            0.0);
}

TEST(DistinctPlaces, NeighboursOfABetterCandidateSayNothingNew) {
  const PointWorld here = make_world(500, 1);
  const PointWorld there = make_world(500, 2);
  Atlas atlas(here.camera, here.scales);
  const MapId map = atlas.new_map();
  std::vector<MapPointId> points(here.p_world.size());
  std::vector<KeyFrameId> ids;
  for (int i = 0; i < 2; ++i) {  // two keyframes that share the points of one place
    const View view = look(here, hand_held(0.1 * i));
    KeyFrame keyframe = keyframe_of(view);
    keyframe.map = map;
    ids.push_back(atlas.add_keyframe(std::move(keyframe)));
    for (std::size_t k = 0; k < view.shown.size(); ++k) {
      const auto shown = static_cast<std::size_t>(view.shown[k]);
      if (points[shown].valid()) {
        atlas.add_observation(points[shown], ids.back(), static_cast<int>(k));
      } else {
        points[shown] = atlas.add_point(here.p_world[shown], ids.back(), static_cast<int>(k));
      }
    }
  }
  for (const KeyFrameId id : ids) atlas.refresh_covisibility(id, 15);
  KeyFrame stranger = keyframe_of(look(there, SE3()));
  stranger.map = map;
  ids.push_back(atlas.add_keyframe(std::move(stranger)));
  const std::vector<PlaceCandidate> candidates{{ids[1], 0.9}, {ids[0], 0.8}, {ids[2], 0.1}};
  const auto places = distinct_places(atlas, candidates, 5);
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].keyframe, ids[1]);
  EXPECT_EQ(places[1].keyframe, ids[2]);
  EXPECT_EQ(distinct_places(atlas, candidates, 1).size(), 1U);
}

}  // namespace
}  // namespace ydd
