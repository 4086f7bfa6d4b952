// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/keyframe_policy.h"

namespace ydd {

void KeyframePolicyOptions::describe(OptionTable& t) {
  t.add("max_interval_s", max_interval_s, {0.0, 60.0}, "s", "a keyframe is considered after this");
  t.add("reference_ratio", reference_ratio, {0.0, 1.0}, "",
        "insert below this share of the reference keyframe's points");
  t.add("weak_ratio", weak_ratio, {0.0, 1.0}, "", "insert at once below this share");
  t.add("min_close_tracked", min_close_tracked, {0, 10000}, "",
        "fewer tracked near points make the map need more");
  t.add("min_close_untracked", min_close_untracked, {0, 10000}, "",
        "if at least so many near points could be added");
  t.add("max_rotation_rad", max_rotation_rad, {0.0, 3.2}, "rad",
        "insert when the view has turned more against the reference keyframe");
  t.add("max_translation_share", max_translation_share, {0.0, 100.0}, "",
        "insert when the camera is farther from the reference keyframe, by median depth");
  t.add("known_rotation_rad", known_rotation_rad, {0.0, 3.2}, "rad",
        "a keyframe of an earlier visit that looks at most so far elsewhere makes a place known");
  t.add("known_translation_share", known_translation_share, {0.0, 100.0}, "",
        "and that stands at most so far away, by median depth");
  t.add("known_inliers", known_inliers, {0, 10000}, "",
        "in a known place insert at once below this number of tracked points");
  t.add("known_interval_s", known_interval_s, {0.0, 3600.0}, "s",
        "in a known place insert otherwise only after this");
  t.add("min_inliers", min_inliers, {0, 10000}, "", "never insert with fewer tracked points");
}

bool needs_keyframe(const KeyframeSituation& s, const KeyframePolicyOptions& o) {
  if (s.inliers < o.min_inliers) return false;
  const bool needs_close =
      s.close_tracked < o.min_close_tracked && s.close_untracked > o.min_close_untracked;
  // The first keyframe's points are fresh and unproven: a second view must come early.
  const double ratio = s.keyframes < 2 ? 0.4 : o.reference_ratio;
  const bool moved =
      s.rotation_rad > o.max_rotation_rad || s.translation_share > o.max_translation_share;
  const bool view_changed = s.inliers < ratio * s.reference_points || needs_close || moved;
  const bool weak = s.inliers < o.weak_ratio * s.reference_points || needs_close;
  if (s.known_place && s.since_keyframe_s < o.known_interval_s &&
      s.inliers >= o.weak_ratio * s.reference_points && s.inliers >= o.known_inliers) {
    return false;
  }
  const bool due = s.since_keyframe_s >= o.max_interval_s || s.mapper_idle || weak;
  return view_changed && due;
}

}  // namespace ydd
