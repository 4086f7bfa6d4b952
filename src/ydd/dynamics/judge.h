// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ydd/detection/detection.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/dynamics/depth_range.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/dynamics/filtered_features.h"
#include "ydd/dynamics/moving_regions.h"
#include "ydd/dynamics/person_tracks.h"
#include "ydd/dynamics/point_rules.h"
#include "ydd/dynamics/scene_switch.h"
#include "ydd/evidence/motion_odds.h"
#include "ydd/features/features.h"
#include "ydd/image/image.h"

namespace ydd {

/// What was found out about one detected object that is not static, for pictures and tests.
struct ObjectJudgement {
  int detection = -1;  ///< index into the detections
  /// What the object catalogue makes of its class.
  Subcategory subcategory = Subcategory::stationary;
  Box box;                          ///< pixels of the image as it was taken
  std::optional<float> depth_m;     ///< approximate minimum depth; none: failed
  Rule rule = Rule::kept;           ///< for points on it; kept: it is static, or judged as a part
  std::optional<DepthRange> range;  ///< of the points that go; none: all, or none when `kept`
  float coincidence = 0;            ///< person: largest coincidence degree with another
  int head = -1;                    ///< person: detection index of its head; -1: none matched
  std::vector<int> hands;           ///< person: detection indices of its hands
  std::int64_t track = -1;          ///< person: the same number in every frame; -1: not followed
  std::optional<float> log_odds;    ///< variant `evidence`: that it moves, class and all
  bool seen_to_move = false;        ///< likewise: by what was seen alone (is_seen_to_move)
};

/// A frame's points and objects, judged.
struct Judgement {
  /// Whether anything was judged at all: a static frame keeps every point.
  bool dynamic_frame = false;
  std::vector<Rule> rules;               ///< one for each keypoint
  std::vector<ObjectJudgement> objects;  ///< the detections that may move
  std::vector<MovingRegion> regions;     ///< all that points were judged by

  int rejected() const;  ///< How many keypoints go: those whose rule is not `kept`.
};

/// Judges one frame by itself, as a dynamic one: which points lie on something that moves. Boxes
/// and keypoints are in pixels of the image as it was taken, `depth_m` is registered to it. Nothing
/// but the detections and the depth is looked at.
Judgement judge_frame(const DynamicsOptions& options, const ObjectCatalogue& catalogue,
                      const Features& features, const Detections& detections,
                      const DepthImage& depth_m);

/// Splits the features: those whose rule is `kept`, and the rejected ones.
/// @throws std::logic_error unless there is one rule for each feature.
FilteredFeatures filter_features(const Features& features, const Judgement& judgement);

/// The YDD method over a sequence (docs/method.md): judge_frame plus what it keeps from frame to
/// frame: the static/dynamic switch, the budget, and persons to be carried over missed detections.
/// Thread: one call at a time.
class DynamicsJudge {
 public:
  /// Starts with nothing seen: the first frame is a dynamic one.
  DynamicsJudge(const DynamicsOptions& options, ObjectCatalogue catalogue);

  /// Judges the next frame. In a static frame every point is kept. Variant `evidence` asks the odds
  /// that surfaces move besides (null: nothing is known), and knows no static frames then.
  Judgement judge(const Features& features, const Detections& detections, const DepthImage& depth_m,
                  const MotionOdds* odds = nullptr);

  /// How many points the next frame should ask the extractor for.
  int budget() const { return budget_; }

  /// What is rejected from the next frame on; persons carried over so far are forgotten.
  void set_variant(Variant variant);

  const DynamicsOptions& options() const { return options_; }      ///< With the variant of now.
  const ObjectCatalogue& catalogue() const { return catalogue_; }  ///< By which classes are judged.

 private:
  /// Regions of all persons of a frame, those included that were missed in it.
  std::vector<MovingRegion> persons_of(const Scene& scene);

  DynamicsOptions options_;
  ObjectCatalogue catalogue_;
  SceneSwitch switch_;
  PersonTracks tracks_;
  int budget_;
};

}  // namespace ydd
