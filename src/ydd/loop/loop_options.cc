// SPDX-License-Identifier: Apache-2.0
#include "ydd/loop/loop_closer.h"

namespace ydd {

void LoopOptions::describe(OptionTable& t) {
  t.add("enabled", enabled, "look for places seen before and correct the map");
  t.add("candidates", candidates, {1, 100}, "", "most similar keyframes that are tried");
  t.add("min_score_ratio", min_score_ratio, {0.0, 2.0}, "",
        "similarity needed, as share of that of neighbouring keyframes");
  t.add("min_age_keyframes", min_age_keyframes, {0, 1000}, "keyframes", "younger ones are no loop");
  t.add("min_inliers", min_inliers, {10, 10000}, "", "map points that must agree");
  t.add("consistent_keyframes", consistent_keyframes, {0, 5}, "",
        "neighbours that must agree with the loop");
  t.add("consistent_inliers", consistent_inliers, {3, 1000}, "", "map points for that");
  t.add("max_drift_m", max_drift_m, {0.0, 1000.0}, "m", "correction that a loop may ask for, ...");
  t.add("max_drift_share", max_drift_share, {0.0, 1.0}, "",
        "... and how much more per metre on the way between the keyframes");
  t.add("max_turn_drift_rad", max_turn_drift_rad, {0.0, 4.0}, "rad",
        "the same for the rotation, ...");
  t.add("max_turn_drift_rad_per_m", max_turn_drift_rad_per_m, {0.0, 1.0}, "rad/m",
        "... and how much more per metre on the way");
  t.add("essential_weight", essential_weight, {1, 1000}, "",
        "shared points from which two keyframes hold each other in the pose graph");
  t.add("graph_nodes", graph_nodes, {10, 1000000}, "",
        "with more keyframes in a map, groups of them move as one in the pose graph");
  t.group("match", match);
  t.group("graph", graph);
  t.add("full_bundle", full_bundle, "adjust the whole map after a loop");
  t.add("bundle_keyframes", bundle_keyframes, {10, 1000000}, "keyframes",
        "in a larger map, as many around the loop are adjusted and the others stay");
  t.group("bundle", bundle);
}

}  // namespace ydd
