// SPDX-License-Identifier: Apache-2.0
#include "ydd/place/place_query.h"

#include <map>
#include <random>
#include <utility>

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
  EXPECT_TRUE(query_places(
                  atlas, BagOfWords{}, [](KeyFrameId) { return true; }, 3)
                  .empty())
      << "nothing in common";
}

/// Bags like those of pictures: some words are in most of them, most words in few.
BagOfWords picture(std::mt19937& random, unsigned place, unsigned vocabulary = 2000) {
  std::map<std::uint16_t, float> weights;
  std::mt19937 of_place(place);
  float sum = 0;
  for (int i = 0; i < 120; ++i) {
    // Two thirds are what the place shows, the rest differs from look to look.
    std::mt19937& source = i % 3 == 0 ? random : of_place;
    const double unit = static_cast<double>(source() % 10000) / 10000.0;
    const auto word = static_cast<std::uint16_t>(vocabulary * unit * unit * unit);
    const float weight = 1.0F + static_cast<float>(word) / static_cast<float>(vocabulary);
    weights[word] += weight;
    sum += weight;
  }
  BagOfWords bag;
  for (const auto& [word, weight] : weights) {
    bag.words.push_back(word);
    bag.weights.push_back(weight / sum);
  }
  return bag;
}

/// An atlas of keyframes that have nothing but words: `per_place` of each of `places`.
Atlas atlas_of_words(unsigned places, int per_place, std::mt19937& random) {
  Atlas atlas(Camera(), PyramidScales::make(8, 1.2));
  const MapId map = atlas.new_map();
  const auto nothing = std::make_shared<const Features>();
  KeyFrameId parent;
  for (unsigned place = 0; place < places; ++place) {
    for (int i = 0; i < per_place; ++i) {
      KeyFrame keyframe;
      keyframe.map = map;
      keyframe.shared_features = nothing;
      keyframe.parent = parent;
      keyframe.words = std::make_shared<const BagOfWords>(picture(random, place));
      parent = atlas.add_keyframe(std::move(keyframe));
    }
  }
  return atlas;
}

void expect_same(const std::vector<PlaceCandidate>& a, const std::vector<PlaceCandidate>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].keyframe, b[i].keyframe);
    EXPECT_EQ(a[i].score, b[i].score);
  }
}

const auto kAnybody = [](KeyFrameId) { return true; };

TEST(QueryPlaces, AnswersAsComparingWithEveryKeyframeDoes) {
  std::mt19937 random(1);
  Atlas atlas = atlas_of_words(60, 10, random);
  const auto third = [](KeyFrameId id) { return id.slot % 3 == 0; };
  for (unsigned query = 0; query < 80; ++query) {  // also of places that are not there
    const BagOfWords words = picture(random, query);
    for (const std::size_t n : {1U, 7U, 24U, 1000U}) {
      expect_same(query_places(atlas, words, kAnybody, n),
                  query_places_exhaustively(atlas, words, kAnybody, n));
      expect_same(query_places(atlas, words, third, n),
                  query_places_exhaustively(atlas, words, third, n));
    }
    // Culled ones are no candidates, whether in a segment or waiting for one.
    const auto ids = atlas.keyframes().ids();
    for (int i = 0; i < 5; ++i) {
      const KeyFrameId id = ids[1 + random() % (ids.size() - 1)];
      if (atlas.find(id)) atlas.cull_keyframe(id);
    }
  }
  EXPECT_LT(atlas.keyframes().size(), 260U);
  EXPECT_TRUE(atlas.check_consistency().empty());
}

TEST(QueryPlaces, EqualScoresGoToTheOlder) {
  std::mt19937 random(2);
  Atlas atlas = atlas_of_words(1, 1, random);
  const BagOfWords words = *atlas.at(atlas.newest_keyframe()).words;
  const KeyFrameId first = atlas.newest_keyframe();
  for (int i = 0; i < 200; ++i) {
    KeyFrame again = atlas.at(first);
    again.parent = first;
    atlas.add_keyframe(std::move(again));
  }
  const auto found = query_places(atlas, words, kAnybody, 3);
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(atlas.at(found[i].keyframe).serial, static_cast<std::int64_t>(i));
  }
}

TEST(QueryPlaces, AWordThatOutweighsAllOthersIsNotCutShort) {
  Atlas atlas(Camera(), PyramidScales::make(8, 1.2));
  const MapId map = atlas.new_map();
  // Heavier than the lists can say: the first looks as good as the second to them.
  const BagOfWords query{{1, 2}, {0.9F, 0.1F}};
  std::vector<KeyFrameId> ids;
  for (const float heavy : {0.3F, 0.9F}) {
    for (int i = 0; i < 100; ++i) {
      KeyFrame keyframe;
      keyframe.map = map;
      keyframe.shared_features = std::make_shared<const Features>();
      keyframe.parent = ids.empty() ? KeyFrameId() : ids.front();
      keyframe.words =
          std::make_shared<const BagOfWords>(BagOfWords{{1, 3}, {heavy, 1.0F - heavy}});
      ids.push_back(atlas.add_keyframe(std::move(keyframe)));
    }
  }
  expect_same(query_places(atlas, query, kAnybody, 1),
              query_places_exhaustively(atlas, query, kAnybody, 1));
}

TEST(QueryPlaces, WithinItsLimitsItStillFindsThePlace) {
  std::mt19937 random(3);
  const Atlas atlas = atlas_of_words(400, 5, random);
  PlaceQueryLimits tight;
  tight.most_postings = 4000;  // of some 240,000
  tight.most_compared = 40;
  int looked_at = 0;
  const auto counted = [&](KeyFrameId) { return ++looked_at > 0; };
  for (unsigned place = 0; place < 400; place += 7) {
    const BagOfWords words = picture(random, place);
    looked_at = 0;
    const auto found = query_places(atlas, words, counted, 5, tight);
    EXPECT_LE(looked_at, 40 + 1);
    ASSERT_EQ(found.size(), 5U);
    expect_same(found, query_places_exhaustively(atlas, words, kAnybody, 5));
  }
}

TEST(QueryPlaces, WithinItsLimitsTheAnswerDoesNotDependOnHowTheMapCameAbout) {
  std::mt19937 random(4);
  Atlas edited = atlas_of_words(100, 8, random);
  const auto ids = edited.keyframes().ids();
  for (int i = 0; i < 300; ++i) {
    const KeyFrameId id = ids[1 + random() % (ids.size() - 1)];
    if (edited.find(id)) edited.cull_keyframe(id);
  }
  AtlasParts parts;
  parts.scales = edited.scales();
  edited.keyframes().for_each(
      [&](KeyFrameId id, const KeyFrame& k) { parts.keyframes.emplace_back(id, k); });
  parts.freed_keyframes = edited.keyframes().freed();
  edited.culled().for_each(
      [&](KeyFrameId id, const CulledKeyFrame& culled) { parts.culled[id] = culled; });
  parts.newest = edited.newest_keyframe();
  parts.next_serial = edited.next_serial();
  parts.maps = edited.maps();
  const Result<Atlas> restored = Atlas::restore(std::move(parts));
  ASSERT_TRUE(restored) << restored.error().message;
  PlaceQueryLimits tight;
  tight.most_postings = 1500;
  tight.most_compared = 10;
  int differ_from_exhaustive = 0;
  for (unsigned place = 0; place < 150; ++place) {
    const BagOfWords words = picture(random, place);
    const auto found = query_places(edited, words, kAnybody, 10, tight);
    expect_same(found, query_places(*restored, words, kAnybody, 10, tight));
    const auto all = query_places_exhaustively(edited, words, kAnybody, 10);
    differ_from_exhaustive += found.back().keyframe != all.back().keyframe ? 1 : 0;
  }
  EXPECT_GT(differ_from_exhaustive, 0) << "the limits were not reached";
}

TEST(QueryIndex, WithoutBagsAnswersAsTheAtlasDoes) {
  std::mt19937 random(6);
  const Atlas atlas = atlas_of_words(80, 6, random);
  const WordIndex whole = WordIndex::without_bags(atlas.word_index().entries(), 1'000'000);
  // Some 25 of 90 words of each: less than a query compares anyway.
  const WordIndex cut = WordIndex::without_bags(atlas.word_index().entries(), 80 * 6 * 25);
  EXPECT_TRUE(whole.complete());
  EXPECT_FALSE(cut.complete());
  int asked = 0;
  const auto bag_of = [&](const WordIndex::Entry& entry) {
    EXPECT_EQ(entry.words, nullptr);
    ++asked;
    return atlas.at(entry.keyframe).words;
  };
  for (unsigned place = 0; place < 80; place += 3) {
    const BagOfWords words = picture(random, place);
    const auto expected = query_places(atlas, words, kAnybody, 5);
    expect_same(query_index(whole, words, kAnybody, bag_of, 5), expected);
    asked = 0;
    expect_same(query_index(cut, words, kAnybody, bag_of, 5), expected);
    EXPECT_LE(asked, 128 + 1);
  }
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
