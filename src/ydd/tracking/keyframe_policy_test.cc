// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/keyframe_policy.h"

#include <string>

#include <gtest/gtest.h>

namespace ydd {
namespace {

/// A frame that nothing speaks for: many points, near ones known, camera where it was.
KeyframeSituation calm() {
  KeyframeSituation s;
  s.since_keyframe_s = 0.1;
  s.inliers = 290;
  s.reference_points = 300;
  s.close_tracked = 200;
  s.close_untracked = 20;
  s.keyframes = 10;
  s.rotation_rad = 0.01;
  s.translation_share = 0.01;
  s.mapper_idle = true;
  return s;
}

struct Case {
  std::string name;
  void (*change)(KeyframeSituation&);
  bool wanted;
};

class KeyframePolicy : public testing::TestWithParam<Case> {};

TEST_P(KeyframePolicy, Decides) {
  KeyframeSituation s = calm();
  GetParam().change(s);
  EXPECT_EQ(needs_keyframe(s, KeyframePolicyOptions{}), GetParam().wanted);
}

const Case kCases[] = {
    {"Calm", [](KeyframeSituation&) {}, false},
    {"TimeAloneIsNoReason", [](KeyframeSituation& s) { s.since_keyframe_s = 30; }, false},
    {"FewOfTheReferencePointsLeft", [](KeyframeSituation& s) { s.inliers = 200; }, true},
    {"ButTooFewToTrust", [](KeyframeSituation& s) { s.inliers = 14; }, false},
    {"TurnedAway", [](KeyframeSituation& s) { s.rotation_rad = 0.2; }, true},
    {"MovedOn", [](KeyframeSituation& s) { s.translation_share = 0.2; }, true},
    {"MovedOnWhileTheMapperIsBusy",
     [](KeyframeSituation& s) {
       s.translation_share = 0.2;
       s.mapper_idle = false;
     },
     false},
    {"MovedOnAndDueWhileTheMapperIsBusy",
     [](KeyframeSituation& s) {
       s.translation_share = 0.2;
       s.mapper_idle = false;
       s.since_keyframe_s = 1.0;
     },
     true},
    {"AlmostNothingLeftWhileTheMapperIsBusy",
     [](KeyframeSituation& s) {
       s.inliers = 60;
       s.mapper_idle = false;
     },
     true},
    {"NearPointsUnmappedWhileTheMapperIsBusy",
     [](KeyframeSituation& s) {
       s.close_tracked = 90;
       s.close_untracked = 80;
       s.mapper_idle = false;
     },
     true},
    {"NearPointsUnmappedButEnoughMapped", [](KeyframeSituation& s) { s.close_untracked = 500; },
     false},
    {"FewNearPointsAtAll",
     [](KeyframeSituation& s) {
       s.close_tracked = 10;
       s.close_untracked = 10;
     },
     false},
    {"AYoungMapWaitsLonger",
     [](KeyframeSituation& s) {
       s.keyframes = 1;
       s.inliers = 200;
     },
     false},
    {"AYoungMapNotForever",
     [](KeyframeSituation& s) {
       s.keyframes = 1;
       s.inliers = 110;
     },
     true},
    {"MovedOnInAKnownPlace",
     [](KeyframeSituation& s) {
       s.translation_share = 0.2;
       s.known_place = true;
     },
     false},
    {"MovedOnInAKnownPlaceAfterAWhile",
     [](KeyframeSituation& s) {
       s.translation_share = 0.2;
       s.known_place = true;
       s.since_keyframe_s = 5.0;
     },
     true},
    {"HardlyAnythingKnownLeftInAKnownPlace",
     [](KeyframeSituation& s) {
       s.inliers = 60;
       s.known_place = true;
     },
     true},
    {"FewPointsInAKnownPlace",
     [](KeyframeSituation& s) {
       s.inliers = 49;
       s.reference_points = 100;
       s.known_place = true;
     },
     true},
};

INSTANTIATE_TEST_SUITE_P(Table, KeyframePolicy, testing::ValuesIn(kCases),
                         [](const auto& test) { return test.param.name; });

TEST(KeyframePolicyOptions, AreInTheTable) {
  KeyframePolicyOptions options;
  OptionTable table;
  options.describe(table);
  EXPECT_EQ(table.options().size(), 12U);
  ASSERT_TRUE(table.set("max_rotation_rad", "0.02", "test"));
  KeyframeSituation s = calm();
  s.rotation_rad = 0.03;
  EXPECT_TRUE(needs_keyframe(s, options));
}

}  // namespace
}  // namespace ydd
