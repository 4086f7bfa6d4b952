// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/tracker.h"

namespace ydd {

std::string_view to_string(TrackingState state) {
  switch (state) {
    case TrackingState::initializing:
      return "initializing";
    case TrackingState::tracking:
      return "tracking";
    case TrackingState::coasting:
      return "coasting";
    case TrackingState::lost:
      return "lost";
  }
  return "";
}

void TrackerOptions::describe(OptionTable& t) {
  t.group("match", match);
  t.group("pose", pose);
  t.group("keyframe", keyframe);
  t.group("relocalization", relocalization);
  t.add("min_initial_points", min_initial_points, {10, 10000}, "",
        "keypoints with depth needed to start a map");
  t.add("motion_radius_px", motion_radius_px, {1.0, 200.0}, "px",
        "search radius around the last frame's points on octave 0");
  t.add("local_radius_factor", local_radius_factor, {0.5, 20.0}, "",
        "widens the search radius around the local map's points");
  t.add("min_motion_matches", min_motion_matches, {3, 1000}, "",
        "below this the motion search is repeated with twice the radius");
  t.add("min_motion_inliers", min_motion_inliers, {3, 1000}, "",
        "points that must agree with the first pose estimate");
  t.add("sure_motion_inliers", sure_motion_inliers, {3, 1000}, "",
        "where fewer agree, the whole picture is searched as well, and taken if twice as many do");
  t.add("min_local_inliers", min_local_inliers, {3, 1000}, "",
        "map points that must agree with the final pose, else tracking is lost");
  t.add("min_agreement", min_agreement, {0.0, 1.0}, "",
        "share that they must be of the map points that seem to be seen, likewise");
  t.add("max_local_keyframes", max_local_keyframes, {1, 1000}, "", "keyframes in the local map");
  t.add("place_candidates", place_candidates, {0, 100}, "",
        "most similar keyframes that are tried when lost");
  t.add("new_map_after_s", new_map_after_s, {0.0, 3600.0}, "s",
        "a new map is started when the camera has been lost for so long");
  t.add("young_map_keyframes", young_map_keyframes, {0, 1000}, "keyframes",
        "a map of so few that is lost is not waited for: a new one starts at once");
  t.add("map_reckoned_after_s", map_reckoned_after_s, {0.0, 60.0}, "s",
        "where motion sensors tell the pose: an unknown view enters the map after so long");
  t.group("arrival", arrival);
  t.group("doubt", doubt);
}

}  // namespace ydd
