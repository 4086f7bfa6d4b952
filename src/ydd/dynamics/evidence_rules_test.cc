// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/evidence_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dynamics/judge.h"
#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::PaintedScene;
using testing::Each;
using testing::ElementsAre;

/// Odds of a scene in which all has stood still for a second.
MotionOdds calm_odds(const PaintedScene& scene) {
  MotionOdds odds;
  odds.depth = coarse_depth(scene.depth(), 8);
  const std::size_t cells = odds.depth.z_m.size();
  odds.log_odds.assign(cells, -4.0F);
  odds.moves.assign(cells, 0);
  odds.calm_s.assign(cells, 1.0F);
  return odds;
}

/// The same, but what is at depth `z_m` moves.
MotionOdds odds_moving_at(const PaintedScene& scene, float z_m) {
  MotionOdds odds = calm_odds(scene);
  for (std::size_t i = 0; i < odds.moves.size(); ++i) {
    if (odds.depth.z_m[i] != z_m) continue;
    odds.log_odds[i] = 4.0F;
    odds.moves[i] = 1;
    odds.calm_s[i] = 0;
  }
  return odds;
}

TEST(PriorLogOdds, APersonMovesRatherThanAThing) {
  EXPECT_GT(prior_log_odds(Rule::body_depth), prior_log_odds(Rule::automatic_depth));
  EXPECT_GT(prior_log_odds(Rule::lone_part), prior_log_odds(Rule::moved_by_hand));
  EXPECT_GT(prior_log_odds(Rule::automatic_depth), 0.0F);
}

TEST(PriorOfCells, IsThatOfTheSurestRegionOverThem) {
  const PaintedScene scene = PaintedScene(4.0F).paint({200, 200, 280, 280}, 2.0F);
  const MotionOdds odds = calm_odds(scene);
  const DepthRange near{1.5F, 2.5F};
  const std::vector<MovingRegion> regions = {
      {0, Rule::body_depth, {160, 160, 239, 320}, near, -1},
      {1, Rule::automatic_depth, {160, 160, 320, 320}, near, -1}};
  const std::vector<float> prior = prior_of_cells(regions, odds);
  const auto at = [&](int x_px, int y_px) {
    return prior[static_cast<std::size_t>(odds.depth.grid.index(x_px / 8, y_px / 8))];
  };
  EXPECT_EQ(at(220, 240), prior_log_odds(Rule::body_depth));
  EXPECT_EQ(at(260, 240), prior_log_odds(Rule::automatic_depth));
  EXPECT_EQ(at(170, 240), 0.0F) << "the wall behind";
  EXPECT_EQ(at(500, 240), 0.0F);
}

TEST(RegionOdds, OfAMaskAreThoseOfItsCells) {
  const PaintedScene scene = PaintedScene(4.0F).paint({200, 200, 240, 280}, 2.0F);
  const MotionOdds odds = odds_moving_at(scene, 2.0F);
  std::vector<std::uint8_t> mask(640U * 480U);
  for (int y = 200; y < 280; ++y) {
    for (int x = 240; x < 280; ++x) mask[static_cast<std::size_t>(y) * 640U + x] = 1;
  }
  const Box box{200, 200, 279, 279};
  // The range would take the half that moves; the mask is on the one that does not.
  const RegionOdds found = region_odds(
      {0, Rule::box, box, DepthRange{1.5F, 2.5F}, -1, GreyImage(640, 480, std::move(mask))}, odds);
  EXPECT_EQ(found.cells, 50);
  EXPECT_FLOAT_EQ(found.moving_share, 0.0F);
}

TEST(RegionOdds, HalfOfItMovingIsSeenToMoveWhateverIsPresumed) {
  EXPECT_TRUE(is_seen_to_move({.log_odds = -3, .moving_share = 0.5F, .cells = 2}));
  EXPECT_FALSE(is_seen_to_move({.log_odds = 6, .moving_share = 0.49F, .cells = 2}));
  EXPECT_FALSE(is_seen_to_move({}));
}

TEST(RegionOdds, AreMeansOverTheCellsInRange) {
  const PaintedScene scene = PaintedScene(4.0F).paint({200, 200, 240, 280}, 2.0F);
  const MotionOdds odds = odds_moving_at(scene, 2.0F);
  const Box box{200, 200, 279, 279};  // half of it moves
  const RegionOdds all = region_odds({0, Rule::box, box, {}, -1}, odds);
  EXPECT_EQ(all.cells, 100);
  EXPECT_FLOAT_EQ(all.log_odds, 0.0F);
  EXPECT_FLOAT_EQ(all.moving_share, 0.5F);
  EXPECT_FLOAT_EQ(all.calm_s, 0.5F);
  const RegionOdds near = region_odds({0, Rule::body_depth, box, DepthRange{1, 3}, -1}, odds);
  EXPECT_EQ(near.cells, 50);
  EXPECT_FLOAT_EQ(near.log_odds, 4.0F);
  EXPECT_FLOAT_EQ(near.moving_share, 1.0F);
  EXPECT_EQ(region_odds({0, Rule::body_depth, box, DepthRange{6, 7}, -1}, odds).cells, 0);
}

TEST(StandsStill, ARegionAtItsBorders) {
  const RegionOdds still{.log_odds = -1.6F, .moving_share = 0.14F, .calm_s = 0.51F, .cells = 1};
  EXPECT_TRUE(stands_still(still, Rule::body_depth));
  RegionOdds other = still;
  other.log_odds = -1.4F;
  EXPECT_FALSE(stands_still(other, Rule::body_depth));
  EXPECT_TRUE(stands_still(other, Rule::automatic_depth)) << "less is presumed of a thing";
  other.log_odds = -0.6F;
  EXPECT_FALSE(stands_still(other, Rule::automatic_depth));
  other = still;
  other.moving_share = 0.16F;
  EXPECT_FALSE(stands_still(other, Rule::body_depth));
  other = still;
  other.calm_s = 0.49F;
  EXPECT_FALSE(stands_still(other, Rule::body_depth));
  other = still;
  other.cells = 0;
  EXPECT_FALSE(stands_still(other, Rule::body_depth));
}

TEST(StandsStill, APointOnASurfaceThatHasForLong) {
  const PaintedScene scene;
  MotionOdds odds = calm_odds(scene);
  EXPECT_TRUE(stands_still(PointSample{240, 240, 4.0F}, odds));
  EXPECT_FALSE(stands_still(PointSample{240, 240, 0.0F}, odds)) << "no reading";
  EXPECT_FALSE(stands_still(PointSample{-10, 240, 4.0F}, odds));
  odds.log_odds.assign(odds.log_odds.size(), -2.9F);
  EXPECT_FALSE(stands_still(PointSample{240, 240, 4.0F}, odds));
  odds = calm_odds(scene);
  odds.calm_s.assign(odds.calm_s.size(), 0.6F);
  EXPECT_FALSE(stands_still(PointSample{240, 240, 4.0F}, odds));
}

TEST(EvidenceRule, OnAMoverBesideItAndElsewhere) {
  const PaintedScene scene = PaintedScene(4.0F).paint({200, 200, 280, 280}, 2.0F);
  const MotionOdds odds = odds_moving_at(scene, 2.0F);
  const DepthImage depth_m = scene.depth();
  EXPECT_EQ(evidence_rule({240, 240, 2.0F}, odds, depth_m, 3), Rule::seen_moving);
  EXPECT_EQ(evidence_rule({240, 240, 0.0F}, odds, depth_m, 3), Rule::seen_moving);
  for (const PointSample& beside : {PointSample{282, 240, 4.0F}, PointSample{197, 240, 4.0F},
                                    PointSample{240, 282, 4.0F}, PointSample{240, 197, 4.0F}}) {
    EXPECT_EQ(evidence_rule(beside, odds, depth_m, 3), Rule::edge);
    EXPECT_EQ(evidence_rule(beside, odds, depth_m, 0), Rule::kept) << "edges are not asked for";
  }
  EXPECT_EQ(evidence_rule({284, 240, 4.0F}, odds, depth_m, 3), Rule::kept);
  EXPECT_EQ(evidence_rule({400, 240, 4.0F}, odds, depth_m, 3), Rule::kept);
  EXPECT_EQ(evidence_rule({240, 240, 2.0F}, calm_odds(scene), depth_m, 3), Rule::kept);
}

// --- The judge --------------------------------------------------------------------------------

/// Body, wall in its box, wall elsewhere.
const std::vector<std::pair<float, float>> kPersonPoints = {{280, 300}, {215, 300}, {500, 300}};

PaintedScene sitting_person() {
  PaintedScene scene;
  return scene.paint({240, 80, 320, 470}, 2.0F).detect("person", {200, 80, 360, 470});
}

Judgement judged(const PaintedScene& scene, Variant variant, const MotionOdds* odds) {
  DynamicsOptions options;
  options.variant = variant;
  DynamicsJudge judge(options, ObjectCatalogue::defaults());
  return judge.judge(scene.points(kPersonPoints), scene.detections(), scene.depth(), odds);
}

TEST(EvidenceJudge, APersonThatStoodStillKeepsItsPoints) {
  const PaintedScene scene = sitting_person();
  const MotionOdds odds = calm_odds(scene);
  const Judgement judgement = judged(scene, Variant::evidence, &odds);
  EXPECT_THAT(judgement.rules, Each(Rule::kept));
  ASSERT_EQ(judgement.objects.size(), 1U);
  ASSERT_TRUE(judgement.objects[0].log_odds.has_value());
  EXPECT_LT(*judgement.objects[0].log_odds, 0.0F);
  EXPECT_EQ(judgement.objects[0].rule, Rule::kept);
  EXPECT_TRUE(judgement.regions.empty());
}

TEST(EvidenceJudge, APersonThatMovesLosesThem) {
  const PaintedScene scene = sitting_person();
  const MotionOdds odds = odds_moving_at(scene, 2.0F);
  const Judgement judgement = judged(scene, Variant::evidence, &odds);
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::body_depth, Rule::kept, Rule::kept));
  ASSERT_EQ(judgement.objects.size(), 1U);
  ASSERT_TRUE(judgement.objects[0].log_odds.has_value());
  EXPECT_GT(*judgement.objects[0].log_odds, 0.0F);
  EXPECT_EQ(judgement.objects[0].rule, Rule::body_depth);
}

TEST(EvidenceJudge, WithoutEvidenceAPersonIsPresumedToMove) {
  const PaintedScene scene = sitting_person();
  MotionOdds odds = calm_odds(scene);
  odds.log_odds.assign(odds.log_odds.size(), 0.0F);
  EXPECT_EQ(judged(scene, Variant::evidence, &odds).rules[0], Rule::body_depth);
}

TEST(EvidenceJudge, WhatMovesNeedsNoName) {
  const PaintedScene scene = PaintedScene().paint({240, 80, 320, 470}, 2.0F);
  const MotionOdds odds = odds_moving_at(scene, 2.0F);
  const Judgement judgement = judged(scene, Variant::evidence, &odds);
  EXPECT_TRUE(judgement.dynamic_frame);
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::seen_moving, Rule::kept, Rule::kept));
}

TEST(EvidenceJudge, WithoutOddsItIsVariantFull) {
  for (const PaintedScene& scene : {sitting_person(), PaintedScene()}) {
    const Judgement full = judged(scene, Variant::full, nullptr);
    const Judgement evidence = judged(scene, Variant::evidence, nullptr);
    EXPECT_EQ(evidence.dynamic_frame, full.dynamic_frame);
    EXPECT_EQ(evidence.rules, full.rules);
    EXPECT_EQ(evidence.regions.size(), full.regions.size());
    for (const ObjectJudgement& object : evidence.objects) EXPECT_FALSE(object.log_odds);
  }
}

TEST(EvidenceJudge, OtherVariantsDoNotAskTheOdds) {
  const PaintedScene scene = sitting_person();
  const MotionOdds odds = calm_odds(scene);
  const Judgement judgement = judged(scene, Variant::full, &odds);
  EXPECT_THAT(judgement.rules, ElementsAre(Rule::body_depth, Rule::kept, Rule::kept));
  EXPECT_FALSE(judgement.objects[0].log_odds);
}

}  // namespace
}  // namespace ydd
