// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/base/options.h"

namespace ydd {

/// When a frame is kept; describe() has the sentences.
struct KeyframePolicyOptions {
  double max_interval_s = 1.0;
  double reference_ratio = 0.75;
  double weak_ratio = 0.25;
  int min_close_tracked = 100;
  int min_close_untracked = 70;
  int min_inliers = 15;
  double max_rotation_rad = 0.10;
  double max_translation_share = 0.10;
  double known_rotation_rad = 0.20;
  double known_translation_share = 0.20;
  int known_inliers = 50;
  double known_interval_s = 5.0;
  double revisit_s = 60.0;  ///< SystemOptions sets it
  void describe(OptionTable& table);
};

/// What the tracker knows when it asks whether this frame should be kept.
struct KeyframeSituation {
  double since_keyframe_s = 0;   ///< time since the last keyframe was submitted
  int inliers = 0;               ///< map points matched in this frame
  int reference_points = 0;      ///< well-observed points of the reference keyframe
  int close_tracked = 0;         ///< keypoints with near depth that show a map point
  int close_untracked = 0;       ///< keypoints with near depth that do not
  int keyframes = 0;             ///< in the map
  double rotation_rad = 0;       ///< against the reference keyframe
  double translation_share = 0;  ///< distance to the reference keyframe by median depth
  bool mapper_idle = true;       ///< nothing waits in front of the mapper
  /// A keyframe of long ago stands here already and looks the same way.
  bool known_place = false;
};

/// True when the map would gain from this frame: the view has changed (few of the reference
/// keyframe's points are left, or it was taken from elsewhere), near points are unmapped, or a
/// second has passed and the mapper has nothing to do. After Mur-Artal and Tardos, "ORB-SLAM2",
/// IEEE T-RO 2017, section III-E.
///
/// In a place that was mapped on an earlier visit only when what is known of it is hardly enough to
/// be tracked (other light, other things), or a few seconds have passed: what is new is taken up,
/// slowly. After Churchill and Newman, "Experience-based navigation for long-term localisation",
/// IJRR 2013, who store a new experience of a place when the old ones fail.
bool needs_keyframe(const KeyframeSituation& situation, const KeyframePolicyOptions& options);

}  // namespace ydd
