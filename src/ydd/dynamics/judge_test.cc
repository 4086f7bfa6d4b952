// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/judge.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::article_options;
using scene_testing::PaintedScene;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

using Pixels = std::vector<std::pair<float, float>>;

Judgement judge(const PaintedScene& scene, const Pixels& pixels, const DynamicsOptions& options) {
  return judge_frame(options, ObjectCatalogue::defaults(), scene.points(pixels), scene.detections(),
                     scene.depth());
}

std::vector<Rule> rules(const PaintedScene& scene, const Pixels& pixels,
                        const DynamicsOptions& options = article_options()) {
  return judge(scene, pixels, options).rules;
}

Rule rule_at(const PaintedScene& scene, float x, float y,
             const DynamicsOptions& options = article_options()) {
  return rules(scene, {{x, y}}, options)[0];
}

DynamicsOptions variant(std::string_view name) {
  DynamicsOptions options;
  options.variant = parse_choice<Variant>(name).value();
  return options;
}

/// A person at 2 m whose body fills the middle of its box; the wall behind is at 4 m.
constexpr Box kPersonBox{200, 80, 360, 470};
PaintedScene& add_person(PaintedScene& scene, const Box& box = kPersonBox, float depth_m = 2.0F) {
  const float side = box.width() / 4;
  scene.paint({box.x0 + side, box.y0, box.x1 - side, box.y1}, depth_m);
  return scene.detect("person", box);
}
PaintedScene one_person() {
  PaintedScene scene;
  add_person(scene);
  return scene;
}

// --- Variants (section 9) -----------------------------------------------------------------------

const Pixels kBodyWallOutside = {{280, 300}, {215, 300}, {500, 300}};

TEST(Variants, OffRejectsNothing) {
  EXPECT_THAT(rules(one_person(), kBodyWallOutside, variant("off")), Each(Rule::kept));
}

TEST(Variants, BoxRejectsWholePersonBoxesOnly) {
  PaintedScene scene = one_person();
  scene.thing("fan", {450, 250, 550, 350}, 1.5F);
  EXPECT_THAT(rules(scene, kBodyWallOutside, variant("box")),
              ElementsAre(Rule::box, Rule::box, Rule::kept));
}

TEST(Variants, PersonKeepsTheWallBehind) {
  PaintedScene scene = one_person();
  scene.thing("fan", {450, 250, 550, 350}, 1.5F);
  EXPECT_THAT(rules(scene, kBodyWallOutside, variant("person")),
              ElementsAre(Rule::body_depth, Rule::kept, Rule::kept));
}

TEST(Variants, PersonKnowsNoEdgesAndNoSmallBoxes) {
  EXPECT_EQ(rule_at(one_person(), 238, 300, variant("person")), Rule::kept);
  PaintedScene far;
  far.thing("person", {300, 200, 320, 250}, 3.5F);
  EXPECT_EQ(rule_at(far, 310, 220, variant("person")), Rule::body_depth);
}

TEST(Variants, FullAddsTheRest) {
  PaintedScene scene = one_person();
  scene.thing("fan", {450, 250, 550, 350}, 1.5F);
  EXPECT_THAT(rules(scene, kBodyWallOutside, variant("full")),
              ElementsAre(Rule::body_depth, Rule::kept, Rule::automatic_depth));
}

TEST(Variants, AMaskStandsForBoxAndDepth) {
  PaintedScene scene = one_person();
  const Box person = scene.detections().front().box;
  std::vector<std::uint8_t> mask(640U * 480U);
  // The upper half of the box, wall and all; the body's lower half is not on it.
  const auto middle = static_cast<int>((person.y0 + person.y1) / 2);
  for (auto y = static_cast<int>(person.y0); y < middle; ++y) {
    for (auto x = static_cast<int>(person.x0); x < static_cast<int>(person.x1); ++x) {
      mask[static_cast<std::size_t>(y) * 640U + static_cast<std::size_t>(x)] = 1;
    }
  }
  Detections masked = scene.detections();
  masked.front().mask = GreyImage(640, 480, std::move(mask));
  const float x = (person.x0 + person.x1) / 2;
  const Features points = scene.points(
      {{x, person.y0 + 20}, {person.x0 + 2, person.y0 + 20}, {x, static_cast<float>(middle) + 20}});
  for (const char* name : {"box", "person", "full"}) {
    const Judgement judgement =
        judge_frame(variant(name), ObjectCatalogue::defaults(), points, masked, scene.depth());
    EXPECT_NE(judgement.rules[0], Rule::kept) << name;
    EXPECT_NE(judgement.rules[1], Rule::kept) << name << ": the wall, on the mask";
    EXPECT_EQ(judgement.rules[2], Rule::kept) << name << ": the body, not on the mask";
  }
}

// --- Bodies (sections 4 and 5) ------------------------------------------------------------------

TEST(Body, HeadAndHandsAreMatchedAndExplained) {
  PaintedScene scene = one_person();
  scene.thing("head", {250, 80, 310, 150}, 2.0F);
  scene.thing("hand", {185, 250, 212, 290}, 1.6F).thing("hand", {348, 250, 375, 290}, 2.4F);
  const Judgement judgement = judge(scene, {{280, 300}}, article_options());
  ASSERT_EQ(judgement.objects.size(), 4U);
  const ObjectJudgement& person = judgement.objects[0];
  EXPECT_EQ(person.detection, 0);
  EXPECT_EQ(person.rule, Rule::body_depth);
  EXPECT_EQ(person.head, 1);
  EXPECT_THAT(person.hands, ElementsAre(2, 3));
  EXPECT_FLOAT_EQ(person.depth_m.value(), 2.0F);
  // head [1.6, 2.6] joined with hands [1.564, 2.58]
  EXPECT_NEAR(person.range->min_m, 1.564, 1e-5);
  EXPECT_NEAR(person.range->max_m, 2.6, 1e-5);
}

TEST(Body, AnArmStretchedForwardIsInRangeWithItsHand) {
  PaintedScene scene = one_person();
  scene.thing("head", {250, 80, 310, 150}, 2.0F).paint({340, 250, 360, 290}, 1.25F);
  EXPECT_EQ(rule_at(scene, 355, 270), Rule::kept);  // a thing in front of the body
  scene.detect("hand", {335, 250, 365, 290});
  EXPECT_EQ(rule_at(scene, 355, 270), Rule::body_depth);
}

TEST(Body, OfThreeHandsTheTwoNearestToTheHeadAreTaken) {
  PaintedScene scene = one_person();
  scene.thing("head", {250, 80, 310, 150}, 2.0F);
  scene.thing("hand", {190, 250, 220, 290}, 1.9F);
  scene.thing("hand", {340, 250, 370, 290}, 1.2F);  // of somebody in front
  scene.thing("hand", {260, 400, 290, 440}, 2.1F);
  const Judgement judgement = judge(scene, {{215, 270}, {350, 200}}, article_options());
  EXPECT_THAT(judgement.objects[0].hands, testing::UnorderedElementsAre(2, 4));
  EXPECT_GT(judgement.objects[0].range->min_m, 1.5F);
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::body_depth, Rule::kept));
}

TEST(Body, AHeadBehindThePersonIsNotItsHead) {
  PaintedScene scene = one_person();
  scene.thing("head", {250, 85, 310, 150}, 2.0F);  // detection 1
  scene.thing("head", {205, 80, 238, 125}, 3.4F);  // somebody far behind, higher up
  const Judgement judgement = judge(scene, {{215, 100}, {280, 300}}, article_options());
  EXPECT_EQ(judgement.objects[0].head, 1);
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::kept, Rule::body_depth));
}

TEST(Body, WithTheWordsOfCocoAlonePersonDepthDecides) {
  const Judgement judgement = judge(one_person(), {{280, 300}, {215, 300}}, DynamicsOptions());
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::body_depth, Rule::kept));
  EXPECT_NEAR(judgement.objects[0].range->min_m, 1.8, 1e-5);
  EXPECT_NEAR(judgement.objects[0].range->max_m, 3.0, 1e-5);
}

TEST(Body, APointWithoutReadingIsInNoRange) {
  PaintedScene scene = one_person();
  scene.paint({270, 290, 290, 310}, 0.0F);
  EXPECT_EQ(rule_at(scene, 280, 300), Rule::kept);
  EXPECT_EQ(rule_at(scene, 280, 300, DynamicsOptions()), Rule::surrounded);
}

// --- Overlapping persons (sections 4 and 8.3) ---------------------------------------------------

/// A person at 1.2 m and one at 2.6 m behind it, moved by so much; a wall at 4 m.
PaintedScene two_persons(float shift) {
  PaintedScene scene;
  const Box front{200, 80, 360, 470};
  const Box behind{200 + shift, 80, 360 + shift, 470};
  scene.paint(behind, 2.6F).paint({front.x0, front.y0 + 60, front.x1, front.y1}, 1.2F);
  return scene.detect("person", front).detect("person", behind);
}

TEST(Overlap, OfThirtyPercentIsJudgedByDepth) {
  PaintedScene scene = two_persons(112);
  scene.thing("head", {250, 80, 300, 140}, 1.2F).thing("head", {380, 80, 420, 130}, 2.6F);
  scene.paint({420, 80, 472, 470}, 4.0F);
  const Judgement judgement = judge(scene, {{250, 300}, {400, 300}, {450, 300}}, article_options());
  EXPECT_NEAR(judgement.objects[0].coincidence, 0.3, 1e-5);
  EXPECT_EQ(judgement.objects[0].rule, Rule::body_depth);
  EXPECT_EQ(judgement.objects[1].rule, Rule::body_depth);
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::body_depth, Rule::body_depth, Rule::kept));
}

TEST(Overlap, OfThirtyPercentMatchesHeadsButNoHands) {
  PaintedScene scene = two_persons(112);
  scene.thing("head", {250, 80, 300, 140}, 1.2F).thing("head", {380, 80, 420, 130}, 2.6F);
  scene.thing("hand", {190, 300, 220, 340}, 1.2F);
  const Judgement judgement = judge(scene, {}, article_options());
  EXPECT_EQ(judgement.objects[0].head, 2);
  EXPECT_EQ(judgement.objects[1].head, 3);
  EXPECT_THAT(judgement.objects[0].hands, IsEmpty());
}

TEST(Overlap, OfSixtyPercentIsRejectedAsAWhole) {
  const Judgement judgement =
      judge(two_persons(64), {{250, 300}, {400, 300}, {210, 90}, {500, 300}}, article_options());
  EXPECT_NEAR(judgement.objects[0].coincidence, 0.6, 1e-5);
  EXPECT_EQ(judgement.objects[0].rule, Rule::full_entangled);
  EXPECT_EQ(judgement.objects[1].rule, Rule::full_entangled);
  EXPECT_FALSE(judgement.objects[0].range);
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::full_entangled, Rule::full_entangled,
                                           Rule::full_entangled, Rule::kept));
}

TEST(Overlap, BeyondTheArticleSixtyPercentKeepsTheWall) {
  PaintedScene scene = two_persons(64);
  scene.paint({410, 80, 424, 470}, 4.0F);
  const Judgement judgement =
      judge(scene, {{250, 300}, {400, 300}, {418, 300}, {210, 90}}, DynamicsOptions());
  EXPECT_THAT(judgement.rules,
              ElementsAre(Rule::body_depth, Rule::body_depth, Rule::kept, Rule::kept));
  EXPECT_EQ(judgement.objects[1].rule, Rule::body_depth);
  EXPECT_TRUE(judgement.objects[1].range->contains(2.6F));
}

TEST(Overlap, BeyondTheArticleAHeadTellsEntangledPersonsApart) {
  PaintedScene scene = two_persons(64);
  scene.thing("head", {290, 80, 350, 140}, 2.6F);
  DynamicsOptions options;
  options.refinement.hidden_bodies = false;
  const Judgement judgement = judge(scene, {{400, 300}, {210, 300}}, options);
  EXPECT_EQ(judgement.objects[0].rule, Rule::body_depth);
  EXPECT_EQ(judgement.objects[0].head, 2);  // of equal tops the first box takes it
  EXPECT_EQ(judgement.objects[1].rule, Rule::full_entangled);
}

// --- Full rejections (section 8) ----------------------------------------------------------------

TEST(FullRejection, APersonWithoutDepth) {
  PaintedScene scene;
  scene.paint(kPersonBox, 0.0F).detect("person", kPersonBox).paint({200, 80, 210, 90}, 4.0F);
  const Judgement judgement = judge(scene, {{280, 300}, {205, 85}, {500, 300}}, article_options());
  EXPECT_THAT(judgement.rules,
              ElementsAre(Rule::full_depth_failed, Rule::full_depth_failed, Rule::kept));
  EXPECT_FALSE(judgement.objects[0].depth_m);
  EXPECT_EQ(rule_at(scene, 280, 300, variant("person")), Rule::full_depth_failed);
}

TEST(FullRejection, APersonWithoutDepthButWithAHead) {
  PaintedScene scene;
  scene.paint(kPersonBox, 0.0F).detect("person", kPersonBox);
  scene.thing("head", {250, 80, 310, 150}, 2.0F).paint({200, 80, 240, 90}, 4.0F);
  EXPECT_THAT(rules(scene, {{280, 100}, {205, 85}}), ElementsAre(Rule::body_depth, Rule::kept));
}

TEST(FullRejection, AFarPersonInATinyBox) {
  PaintedScene scene;
  scene.thing("person", {300, 200, 330, 290}, 3.8F);  // 2700 of 307200 pixels
  scene.paint({300, 200, 310, 210}, 6.0F);
  EXPECT_THAT(rules(scene, {{315, 250}, {305, 205}, {340, 250}}),
              ElementsAre(Rule::full_small_box, Rule::full_small_box, Rule::kept));
}

TEST(FullRejection, AFanFarAwayOrWithoutDepth) {
  PaintedScene far;
  far.thing("fan", {300, 200, 330, 230}, 3.8F);
  EXPECT_EQ(rule_at(far, 315, 215), Rule::full_small_box);
  PaintedScene dark;
  dark.thing("fan", {300, 200, 400, 300}, 0.0F);
  EXPECT_EQ(rule_at(dark, 350, 250), Rule::full_depth_failed);
}

TEST(FullRejection, AnObjectInAHandWithoutDepth) {
  PaintedScene scene = one_person();
  scene.thing("hand", {340, 250, 370, 290}, 2.0F).thing("cup", {365, 260, 385, 280}, 0.0F);
  EXPECT_EQ(rule_at(scene, 380, 270), Rule::full_depth_failed);
  PaintedScene desk = one_person();
  desk.thing("cup", {465, 260, 485, 280}, 0.0F);
  EXPECT_EQ(rule_at(desk, 480, 270), Rule::kept);  // its depth is not needed
}

TEST(FullRejection, AHandWithoutDepth) {
  PaintedScene scene = one_person();
  scene.thing("hand", {362, 250, 392, 290}, 0.0F);
  EXPECT_EQ(rule_at(scene, 380, 270), Rule::full_depth_failed);
}

// --- Automatic objects (section 5) --------------------------------------------------------------

TEST(Automatic, AFanIsRejectedByItsDepth) {
  PaintedScene scene;
  scene.paint({320, 220, 380, 280}, 2.0F).detect("fan", {300, 200, 400, 300});
  const Judgement judgement = judge(scene, {{350, 250}, {305, 205}, {318, 250}}, article_options());
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::automatic_depth, Rule::kept, Rule::edge));
  EXPECT_NEAR(judgement.objects[0].range->min_m, 2.0 - 0.14, 1e-5);
  EXPECT_NEAR(judgement.objects[0].range->max_m, 2.7, 1e-5);
}

// --- Potentially dynamic objects (section 6) ----------------------------------------------------

TEST(Moved, ACupInAHandMoves) {
  PaintedScene scene = one_person();
  scene.thing("cup", {365, 250, 425, 310}, 1.5F).thing("hand", {345, 260, 385, 300}, 1.47F);
  const Judgement judgement = judge(scene, {{418, 305}}, article_options());
  EXPECT_EQ(judgement.rules[0], Rule::moved_by_hand);
  EXPECT_EQ(judgement.objects[1].rule, Rule::moved_by_hand);
}

TEST(Moved, AHandBeforeACupOnADeskDoesNotMoveIt) {
  PaintedScene scene = one_person();
  scene.thing("cup", {365, 250, 425, 310}, 2.9F).thing("hand", {345, 260, 385, 300}, 1.5F);
  scene.thing("hand", {190, 250, 220, 290}, 2.0F);  // the other hand is in sight
  const Judgement judgement = judge(scene, {{418, 305}}, article_options());
  EXPECT_EQ(judgement.rules[0], Rule::kept);
  EXPECT_EQ(judgement.objects[1].rule, Rule::kept);
}

TEST(Moved, APushedChairWithHiddenHandsMoves) {
  PaintedScene scene = one_person();
  scene.thing("chair", {340, 250, 480, 470}, 2.3F);
  EXPECT_EQ(rule_at(scene, 450, 400), Rule::moved_near_body);
  EXPECT_EQ(rule_at(scene, 470, 300), Rule::moved_near_body);
}

TEST(Moved, AChairBehindAPersonStays) {
  PaintedScene scene = one_person();
  scene.paint({340, 250, 480, 470}, 3.4F).detect("chair", {340, 250, 480, 470});
  EXPECT_EQ(rule_at(scene, 450, 400), Rule::kept);
}

TEST(Moved, AChairBesideAPersonWithBothHandsInSightStays) {
  PaintedScene scene = one_person();
  scene.thing("chair", {340, 250, 480, 470}, 2.3F);
  scene.thing("hand", {190, 250, 220, 290}, 2.0F).thing("hand", {262, 250, 290, 290}, 2.0F);
  EXPECT_EQ(rule_at(scene, 450, 400), Rule::kept);
}

TEST(Moved, AStaticClassNeverMoves) {
  PaintedScene scene = one_person();
  scene.thing("desk", {340, 250, 480, 470}, 2.3F);
  const Judgement judgement = judge(scene, {{450, 400}}, article_options());
  EXPECT_EQ(judgement.rules[0], Rule::kept);
  EXPECT_EQ(judgement.objects.size(), 1U);
}

TEST(Moved, BeyondTheArticleAnyHandMovesThings) {
  PaintedScene scene = two_persons(112);  // overlapping: hands are not matched
  scene.thing("cup", {130, 250, 190, 310}, 0.9F).thing("hand", {160, 260, 205, 300}, 0.88F);
  EXPECT_EQ(rule_at(scene, 132, 255), Rule::kept);
  EXPECT_EQ(rule_at(scene, 132, 255, DynamicsOptions()), Rule::moved_by_hand);
}

// --- Refinements of the point set (section 7) ---------------------------------------------------

TEST(Edge, PointsBesideAMovingSilhouette) {
  EXPECT_EQ(rule_at(one_person(), 237, 300), Rule::edge);  // the body begins at 240
  EXPECT_EQ(rule_at(one_person(), 236, 300), Rule::kept);
  PaintedScene filled;
  filled.thing("person", kPersonBox, 2.0F);
  EXPECT_EQ(rule_at(filled, 362, 300), Rule::edge);  // outside the box
  EXPECT_EQ(rule_at(filled, 363, 300), Rule::kept);
}

TEST(AroundHand, AnUndetectedThingInTheHand) {
  PaintedScene scene = one_person();
  scene.thing("hand", {380, 250, 420, 290}, 1.8F).paint({420, 260, 436, 280}, 1.85F);
  EXPECT_EQ(rule_at(scene, 430, 270), Rule::around_hand);
  EXPECT_EQ(rule_at(scene, 432, 242), Rule::kept);  // the wall in the scaled box
  scene.paint({450, 260, 460, 280}, 1.85F);
  EXPECT_EQ(rule_at(scene, 455, 270), Rule::kept);  // outside it
}

// --- Beyond the article -------------------------------------------------------------------------

TEST(LoneParts, AHeadWithoutAPerson) {
  PaintedScene scene;
  scene.thing("head", {300, 200, 340, 250}, 2.0F).paint({300, 200, 310, 210}, 4.0F);
  EXPECT_THAT(rules(scene, {{320, 225}, {302, 202}}), Each(Rule::kept));
  EXPECT_THAT(rules(scene, {{320, 225}, {302, 202}}, DynamicsOptions()),
              ElementsAre(Rule::lone_part, Rule::kept));
}

TEST(Connected, ABookThatNobodyDetected) {
  PaintedScene scene;
  scene.thing("person", kPersonBox, 2.0F).paint({360, 250, 410, 330}, 1.97F);
  EXPECT_EQ(rule_at(scene, 390, 300), Rule::kept);
  EXPECT_EQ(rule_at(scene, 390, 300, DynamicsOptions()), Rule::connected);
}

// --- Frames in a row ----------------------------------------------------------------------------

TEST(Judge, StaysStaticFromTheFifthFrameWithoutADynamicObject) {
  DynamicsJudge dynamics(DynamicsOptions(), ObjectCatalogue::defaults());
  const PaintedScene empty;
  const Features features = empty.points({{280, 300}});
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(dynamics.judge(features, {}, empty.depth()).dynamic_frame) << i;
  }
  EXPECT_FALSE(dynamics.judge(features, {}, empty.depth()).dynamic_frame);
  const PaintedScene scene = one_person();
  const Judgement judgement =
      dynamics.judge(scene.points({{280, 300}}), scene.detections(), scene.depth());
  EXPECT_TRUE(judgement.dynamic_frame);
  EXPECT_EQ(judgement.rules[0], Rule::body_depth);
}

TEST(Judge, TheBudgetFollowsTheRejectedPoints) {
  DynamicsJudge dynamics(DynamicsOptions(), ObjectCatalogue::defaults());
  EXPECT_EQ(dynamics.budget(), 1000);
  const PaintedScene scene = one_person();
  dynamics.judge(scene.points({{280, 300}, {500, 300}, {510, 300}, {520, 300}}), scene.detections(),
                 scene.depth());
  EXPECT_EQ(dynamics.budget(), 1333);
  dynamics.judge(scene.points({{280, 300}, {281, 300}, {500, 300}}), scene.detections(),
                 scene.depth());
  EXPECT_EQ(dynamics.budget(), 3500);  // 1000 * 3 * 1.2, limited
  const PaintedScene empty;
  for (int i = 0; i < 5; ++i) dynamics.judge(empty.points({{1, 1}}), {}, empty.depth());
  EXPECT_EQ(dynamics.budget(), 1000);
}

TEST(Judge, APersonMissedInOneFrameIsBridged) {
  const PaintedScene scene = one_person();
  const Features features = scene.points({{280, 300}, {500, 300}});
  for (const bool refined : {true, false}) {
    DynamicsOptions options;
    options.refinement.enabled = refined;
    DynamicsJudge dynamics(options, ObjectCatalogue::defaults());
    for (int i = 0; i < 3; ++i) dynamics.judge(features, scene.detections(), scene.depth());
    const Judgement missed = dynamics.judge(features, {}, scene.depth());
    EXPECT_EQ(missed.rules[0], refined ? Rule::bridged : Rule::kept);
    EXPECT_EQ(missed.rules[1], Rule::kept);
  }
}

TEST(Judge, StrangeInputIsNoReasonToFail) {
  PaintedScene scene(0.0F);
  scene.detect("person", {0, 0, 0, 0}).detect("person", {-50, -50, 700, 500});
  scene.detect("hand", {630, 470, 640, 480}).detect("cup", {639, 479, 640, 480});
  scene.detect("", {10, 10, 20, 20});
  EXPECT_EQ(rule_at(scene, 320, 240, DynamicsOptions()), Rule::full_depth_failed);
  const Judgement none = judge_frame(DynamicsOptions(), ObjectCatalogue::defaults(), Features(),
                                     scene.detections(), DepthImage());
  EXPECT_THAT(none.rules, IsEmpty());
}

TEST(Observe, SplitsKeptFromRejected) {
  const PaintedScene scene = one_person();
  const Features features = scene.points({{280, 300}, {500, 300}, {215, 300}, {285, 310}});
  const FilteredFeatures filtered = filter_features(
      features, judge(scene, {{280, 300}, {500, 300}, {215, 300}, {285, 310}}, article_options()));
  ASSERT_EQ(filtered.kept->size(), 2U);
  EXPECT_EQ(filtered.kept->keypoints[0].x_px, 500);
  EXPECT_EQ(filtered.kept->keypoints[1].x_px, 215);
  ASSERT_EQ(filtered.rejected.size(), 2U);
  EXPECT_EQ(filtered.rejected[0].rule, Rule::body_depth);
  EXPECT_EQ(filtered.rejected[0].depth_m, 2.0F);
  EXPECT_EQ(filtered.rejected[1].keypoint.x_px, 285);
  EXPECT_EQ(filtered.extracted(), 4U);
  const auto counts = count_rules(filtered);
  EXPECT_EQ(counts[static_cast<std::size_t>(Rule::kept)], 2);
  EXPECT_EQ(counts[static_cast<std::size_t>(Rule::body_depth)], 2);
}

TEST(Observe, NeedsOneRuleForEachFeature) {
  EXPECT_THROW(filter_features(one_person().points({{1, 1}}), Judgement()), std::logic_error);
}

TEST(Rules, EachHasItsName) {
  EXPECT_EQ(to_string(Rule::kept), "kept");
  EXPECT_EQ(to_string(Rule::seen_moving), "seen_moving");
  EXPECT_EQ(to_string(Rule::bridged), "bridged");
  EXPECT_EQ(static_cast<int>(Rule::bridged) + 1, kRuleCount);
}

}  // namespace
}  // namespace ydd
