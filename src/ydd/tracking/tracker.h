// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/timing.h"
#include "ydd/matching/keyframe_candidate.h"
#include "ydd/matching/pose_from_matches.h"
#include "ydd/matching/relocalization.h"
#include "ydd/tracking/arrival.h"
#include "ydd/tracking/depth_watch.h"
#include "ydd/tracking/keyframe_policy.h"

namespace ydd {

/// Whether it is known where the camera is.
enum class TrackingState {
  initializing,  ///< no map yet
  tracking,
  coasting,  ///< what the sensor says is in doubt, or it shows nothing known and other senses tell
             ///< the pose: nothing of it enters the map
  lost,      ///< the map exists, the camera's place in it is unknown
};
std::string_view to_string(TrackingState state);  ///< The state's name in files: "tracking".

/// The settings of each step of tracking; describe() has the sentences.
struct TrackerOptions {
  MatchLimits match;
  PoseOnlyOptions pose;
  KeyframePolicyOptions keyframe;
  RelocalizationOptions relocalization;
  int min_initial_points = 50;
  double motion_radius_px = 15.0;
  double local_radius_factor = 3.0;
  int min_motion_matches = 20;
  int min_motion_inliers = 10;
  int sure_motion_inliers = 40;
  int min_local_inliers = 20;
  double min_agreement = 0.25;
  int max_local_keyframes = 80;
  double close_depth_m = 3.0;  ///< SystemOptions sets it
  int place_candidates = 20;
  double new_map_after_s = 3.0;
  ArrivalOptions arrival;
  int young_map_keyframes = 5;
  double map_reckoned_after_s = 0.5;
  DoubtOptions doubt;
  void describe(OptionTable& table);
};

/// What became of a frame.
struct TrackResult {
  TrackingState state = TrackingState::initializing;  ///< after this frame
  SE3 T_world_camera;                                 ///< valid when the reference is
  KeyFrameId reference;    ///< valid when tracking, except for the frame that starts a map; when
                           ///< coasting, where the colour image alone tells the pose
  std::string doubt;       ///< why it coasts
  SE3 T_reference_camera;  ///< where the camera was in the frame of the reference keyframe
  std::optional<SE3> T_camera_last;        ///< the camera's motion since the last frame with a pose
  std::optional<SE3> T_camera_seen;        ///< the same since the last frame whose pose was seen
  std::optional<ReckonedMotion> reckoned;  ///< what the pose is from, where it was not seen
  int motion_inliers = 0;                  ///< points that agree with the first pose estimate
  int inliers = 0;                         ///< map points that agree with the final pose
  double agreement = 0;                    ///< their share of those that seem to be seen, 0 to 1
  int local_points = 0;                    ///< size of the local map
  std::vector<MapPointId> points;          ///< per keypoint of the frame
  /// What the map should keep of the frame; none: nothing.
  std::optional<KeyFrameCandidate> candidate;
  StageTimes times;  ///< of its steps, in order
};

/// Follows the camera from frame to frame against the newest map.
///
/// A frame whose depth contradicts the map is followed by its colour alone, and neither it nor a
/// pose that no body reaches enters the map (docs/never-lost.md).
///
/// One frame: predict the pose -> find the last frame's points near it -> pose -> find the local
/// map's points -> pose -> decide whether to keep the frame. Owns nothing of the map: it reads the
/// atlas it is given and proposes keyframes by value.
/// Thread: one. Deterministic.
class Tracker {
 public:
  /// With `in_known_map` it starts lost in a map that is there, instead of starting one.
  explicit Tracker(const TrackerOptions& options, bool in_known_map = false);

  /// `frame` comes without pose and points. `atlas` is the newest published one. `mapper_idle`
  /// tells that no candidate waits.
  TrackResult track(TrackedFrame frame, const Atlas& atlas, bool mapper_idle);

  /// Whether to propose no keyframe and start no map, however long it is lost. May be switched
  /// between any two frames.
  void set_localization_only(bool on) { localization_only_ = on; }
  /// Whether it proposes nothing; see set_localization_only.
  bool localization_only() const { return localization_only_; }

  TrackingState state() const { return state_; }  ///< After the newest frame.

 private:
  struct Views {
    std::uint32_t generation = 0;
    int visible = 0;
    int found = 0;
    int contradicted = 0;  ///< in a row
    bool listed = false;   ///< in viewed_
  };

  bool find_pose(const Atlas& atlas, TrackedFrame& frame, TrackResult& result);
  TrackResult conclude(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                       bool mapper_idle);
  TrackResult initialize(TrackedFrame frame);
  bool adopt_first_keyframe(const Atlas& atlas);
  std::vector<KeyFrameId> similar_places(const TrackedFrame& frame, const Atlas& atlas) const;
  void refresh_last_frame(const Atlas& atlas);
  std::optional<PoseFromMatches> initial_pose(const TrackedFrame& frame, const Atlas& atlas) const;
  std::optional<PoseFromMatches> pose_by_motion(const TrackedFrame& frame,
                                                const Atlas& atlas) const;
  std::optional<PoseFromMatches> pose_by_reference(const TrackedFrame& frame,
                                                   const Atlas& atlas) const;
  std::optional<PoseFromMatches> pose_by_relocalization(const TrackedFrame& frame,
                                                        const Atlas& atlas) const;
  bool track_local_map(const Atlas& atlas, TrackedFrame& frame, TrackResult& result);
  bool contradicted(const Atlas& atlas, const Eigen::Vector3d& p_world,
                    const TrackedFrame& frame) const;
  void count_views(const Atlas& atlas, const LocalMap& local, const LocalSearch& search,
                   const TrackedFrame& frame);
  std::vector<PointViews> take_views();
  void set_pose(const Atlas& atlas, TrackedFrame& frame, const LocalMap& local,
                TrackResult& result);
  KeyframeSituation situation(const Atlas& atlas, const TrackedFrame& frame,
                              const TrackResult& result, bool mapper_idle) const;
  bool confirm_place(const Atlas& atlas, const TrackedFrame& frame, const TrackResult& result);
  bool is_known_place(const Atlas& atlas, const TrackedFrame& frame, const TrackResult& result,
                      double depth_m) const;
  TrackResult finish_tracked(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                             bool mapper_idle);
  TrackResult finish_coasting(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                              const std::string& doubt);
  TrackResult finish_lost(TrackedFrame frame, const Atlas& atlas, TrackResult result);
  TrackResult finish_doubted(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                             std::string doubt);  // a copy: often the reason that is replaced
  std::optional<TrackResult> finish_reckoned(TrackedFrame frame, const Atlas& atlas,
                                             const TrackResult& failed);
  bool looks_through_the_map(const TrackedFrame& frame, const Atlas& atlas) const;
  void map_reckoned(TrackedFrame frame, TrackResult& result);
  bool shows_enough(const TrackedFrame& frame) const;
  bool is_reckoned(const TrackedFrame& frame) const;
  bool is_just_found(const TrackedFrame& frame) const;
  bool is_where_reckoned(const TrackedFrame& frame) const;
  void take_motion(const TrackedFrame& frame, TrackResult& result);
  bool moves_as_a_body(const TrackedFrame& frame) const;
  bool depth_is_doubtful(const Atlas& atlas, TrackedFrame& frame);
  SE3 predicted_motion(const TrackedFrame& frame) const;
  bool is_young(const Atlas& atlas) const;

  TrackerOptions options_;
  TrackingState state_ = TrackingState::initializing;
  std::optional<TrackedFrame> last_;  ///< the last frame with a pose
  KeyFrameId last_reference_;
  SE3 T_reference_last_;
  std::optional<SE3> T_camera_last_;    ///< velocity: motion over the last frame interval, ...
  double motion_interval_s_ = 0;        ///< ... which took so long
  std::optional<SE3> T_reckoned_last_;  ///< what `last_` is to the newest frame, which saw nothing
  std::optional<Timestamp> unknown_since_;  ///< when such frames began to show enough for a map
  std::optional<Timestamp> found_again_;    ///< the last time that this had an end
  DepthWatch depth_watch_;
  std::vector<PointMatch> local_matches_;  ///< of this frame, also those that the pose left out
  Doubt doubt_;
  Timestamp last_candidate_stamp_;
  std::optional<Timestamp> lost_since_;
  Arrival arrival_;
  bool localization_only_ = false;
  std::vector<Views> views_;           ///< by slot of the point
  std::vector<std::uint32_t> viewed_;  ///< slots with views since the last candidate
};

}  // namespace ydd
