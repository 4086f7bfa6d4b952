// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/body_matching.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const BodyMatchingOptions kMatching;

SceneObject object(Subcategory subcategory, const Box& box, std::optional<float> depth_m) {
  SceneObject result;
  result.subcategory = subcategory;
  result.box = box;
  result.depth_m = depth_m;
  return result;
}
SceneObject person(const Box& box, std::optional<float> depth_m = 2.0F) {
  return object(Subcategory::person, box, depth_m);
}
SceneObject head(const Box& box, std::optional<float> depth_m = 2.0F) {
  return object(Subcategory::head, box, depth_m);
}
SceneObject hand(const Box& box, std::optional<float> depth_m = 2.0F) {
  return object(Subcategory::hand, box, depth_m);
}

constexpr Box kPerson{100, 50, 250, 450};
constexpr Box kHead{150, 50, 200, 120};

TEST(MatchHead, NoneAndOneAreTakenAsTheyAre) {
  EXPECT_EQ(match_head(std::vector{person(kPerson)}, 0, {}, kMatching), -1);
  // One: even in the lower half and far behind.
  const std::vector objects = {person(kPerson), head({150, 350, 200, 420}, 5.0F)};
  EXPECT_EQ(match_head(objects, 0, {1}, kMatching), 1);
}

TEST(MatchHead, OfMoreOnlyThoseInTheUpperPartOfAnUprightPerson) {
  const std::vector objects = {person(kPerson), head({150, 350, 200, 420}),
                               head({150, 90, 200, 160})};
  EXPECT_EQ(match_head(objects, 0, {1, 2}, kMatching), 2);
}

TEST(MatchHead, ALyingPersonHasNoUpperPart) {
  const std::vector objects = {person({50, 300, 450, 450}), head({60, 400, 120, 450}),
                               head({200, 440, 240, 450})};
  EXPECT_EQ(match_head(objects, 0, {1, 2}, kMatching), 1);
}

TEST(MatchHead, AHeadBehindAnotherPersonIsTooFarAway) {
  const std::vector objects = {person(kPerson), head({160, 50, 210, 110}, 3.5F),
                               head({150, 60, 200, 130}, 2.1F)};
  EXPECT_EQ(match_head(objects, 0, {1, 2}, kMatching), 2);
}

TEST(MatchHead, OfThoseLeftTheNearestTopBorderWins) {
  const std::vector objects = {person(kPerson), head({110, 90, 150, 140}),
                               head({150, 55, 200, 120})};
  EXPECT_EQ(match_head(objects, 0, {1, 2}, kMatching), 2);
}

TEST(MatchHead, NoneWhenNoneQualifies) {
  const std::vector objects = {person(kPerson, std::nullopt), head(kHead),
                               head({150, 90, 200, 160})};
  EXPECT_EQ(match_head(objects, 0, {1, 2}, kMatching), -1);
}

TEST(MatchHands, UpToTwoAreTakenAsTheyAre) {
  const std::vector objects = {person(kPerson), hand({90, 200, 130, 240}, 9.0F),
                               hand({240, 200, 280, 240}, std::nullopt)};
  EXPECT_THAT(match_hands(objects, 0, -1, {}, kMatching), IsEmpty());
  EXPECT_THAT(match_hands(objects, 0, -1, {1, 2}, kMatching), ElementsAre(1, 2));
}

TEST(MatchHands, OfThreeTheTwoNearestToTheHead) {
  const std::vector objects = {person(kPerson, 3.0F), head(kHead, 2.0F),
                               hand({90, 200, 130, 240}, 2.3F), hand({240, 200, 280, 240}, 1.4F),
                               hand({160, 300, 190, 330}, 2.1F)};
  EXPECT_THAT(match_hands(objects, 0, 1, {2, 3, 4}, kMatching), ElementsAre(4, 2));
}

TEST(MatchHands, WithoutAHeadThePersonIsTheMeasure) {
  const std::vector objects = {person(kPerson, 3.0F), hand({90, 200, 130, 240}, 2.2F),
                               hand({240, 200, 280, 240}, 2.9F), hand({160, 300, 190, 330}, 3.3F)};
  // The first one is 0.8 m away: too far.
  EXPECT_THAT(match_hands(objects, 0, -1, {1, 2, 3}, kMatching), ElementsAre(2, 3));
}

TEST(MatchHands, AHandWithoutDepthCannotWinAChoice) {
  const std::vector objects = {person(kPerson), head(kHead),
                               hand({90, 200, 130, 240}, std::nullopt),
                               hand({240, 200, 280, 240}, 2.0F), hand({160, 300, 190, 330}, 2.5F)};
  EXPECT_THAT(match_hands(objects, 0, 1, {2, 3, 4}, kMatching), ElementsAre(3, 4));
}

TEST(MatchHands, NoMeasureAtAllNoHands) {
  const std::vector objects = {person(kPerson, std::nullopt), hand({90, 200, 130, 240}),
                               hand({240, 200, 280, 240}), hand({160, 300, 190, 330})};
  EXPECT_THAT(match_hands(objects, 0, -1, {1, 2, 3}, kMatching), IsEmpty());
}

TEST(MatchBodies, AFreePersonGetsHeadAndHands) {
  const std::vector objects = {hand({90, 200, 130, 240}), person(kPerson), head(kHead),
                               hand({600, 200, 630, 240})};
  const auto bodies = match_bodies(objects, kMatching, false);
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_EQ(bodies[0].person, 1);
  EXPECT_EQ(bodies[0].head, 2);
  EXPECT_THAT(bodies[0].hands, ElementsAre(0));
  EXPECT_FALSE(bodies[0].entangled);
}

/// Two persons side by side of whom each is covered by `share`, with a head each and hands.
std::vector<SceneObject> persons_overlapping_by(float share) {
  const float shift = 150 * (1 - share);
  return {person({100, 50, 250, 450}, 2.0F), person({100 + shift, 50, 250 + shift, 450}, 2.0F),
          head({120, 50, 160, 110}, 2.0F), head({190 + shift, 50, 230 + shift, 110}, 2.0F),
          hand({90, 250, 120, 290}, 2.0F)};
}

TEST(MatchBodies, AtThirtyPercentOverlapHeadsButNoHands) {
  for (const bool own_heads : {false, true}) {
    const auto bodies = match_bodies(persons_overlapping_by(0.3F), kMatching, own_heads);
    ASSERT_EQ(bodies.size(), 2U);
    for (const Body& body : bodies) {
      EXPECT_NEAR(body.coincidence, 0.3F, 1e-5);
      EXPECT_FALSE(body.entangled);
      EXPECT_THAT(body.hands, IsEmpty());
    }
    EXPECT_EQ(bodies[0].head, 2);
    EXPECT_EQ(bodies[1].head, 3);
  }
}

TEST(MatchBodies, AtSixtyPercentOverlapNothingByTheArticle) {
  for (const Body& body : match_bodies(persons_overlapping_by(0.6F), kMatching, false)) {
    EXPECT_NEAR(body.coincidence, 0.6F, 1e-5);
    EXPECT_TRUE(body.entangled);
    EXPECT_EQ(body.head, -1);
    EXPECT_THAT(body.hands, IsEmpty());
  }
}

TEST(MatchBodies, ExactlyHalfIsNotEntangled) {
  for (const Body& body : match_bodies(persons_overlapping_by(0.5F), kMatching, false)) {
    EXPECT_FALSE(body.entangled);
    EXPECT_GE(body.head, 0);
  }
}

TEST(MatchBodies, AnEntangledPersonKeepsItsOwnHead) {
  // The second stands behind the first, a head higher.
  const std::vector objects = {person({100, 100, 250, 450}, 1.2F),
                               person({110, 40, 240, 440}, 1.2F), head({150, 100, 200, 160}, 1.2F),
                               head({150, 40, 200, 98}, 2.2F)};
  const auto bodies = match_bodies(objects, kMatching, true);
  ASSERT_EQ(bodies.size(), 2U);
  EXPECT_TRUE(bodies[0].entangled);
  EXPECT_EQ(bodies[0].head, 2);
  EXPECT_TRUE(bodies[1].entangled);
  EXPECT_EQ(bodies[1].head, 3);
}

TEST(MatchBodies, AHeadOfOneIsNoCandidateOfTheOther) {
  // Only the first person shows a head; it meets both boxes.
  const std::vector objects = {person({100, 50, 250, 450}), person({200, 80, 350, 450}),
                               head({180, 50, 230, 110})};
  EXPECT_EQ(match_bodies(objects, kMatching, false)[1].head, 2);
  EXPECT_EQ(match_bodies(objects, kMatching, true)[1].head, -1);
  EXPECT_EQ(match_bodies(objects, kMatching, true)[0].head, 2);
}

TEST(OwnersOfHeads, OnlyHeadsAtTheTopOfABox) {
  const std::vector objects = {person(kPerson), head({150, 200, 200, 260}), head(kHead),
                               head({240, 50, 300, 120})};
  EXPECT_THAT(owners_of_heads(objects, kMatching), ElementsAre(-1, -1, 0, -1));
}

TEST(DepthsOf, TakesTheNearestAndFarthestHandWithDepth) {
  const std::vector objects = {person(kPerson, 2.5F), head(kHead, std::nullopt),
                               hand({90, 200, 130, 240}, 2.3F), hand({240, 200, 280, 240}, 1.4F)};
  const BodyDepths depths = depths_of({0, 0, false, 1, {2, 3}}, objects);
  EXPECT_EQ(depths.person_m, 2.5F);
  EXPECT_FALSE(depths.head_m);
  EXPECT_EQ(depths.nearest_hand_m, 1.4F);
  EXPECT_EQ(depths.farthest_hand_m, 2.3F);
  const BodyDepths none = depths_of({0, 0, false, -1, {}}, objects);
  EXPECT_FALSE(none.nearest_hand_m);
  EXPECT_FALSE(none.farthest_hand_m);
}

}  // namespace
}  // namespace ydd
