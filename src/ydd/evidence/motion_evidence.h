// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/evidence/ego_motion.h"
#include "ydd/evidence/evidence_options.h"
#include "ydd/evidence/motion_odds.h"
#include "ydd/evidence/seen_space.h"
#include "ydd/evidence/surfaces.h"

namespace ydd {

/// Tells from the last frames what moves, whatever it is called.
///
/// One frame: carry the odds over -> find the features of an earlier frame again -> the motion of
/// the camera that standing surfaces agree with -> which surfaces have moved against it, which are
/// where earlier frames saw nothing, which were there before -> gathered over pieces of surface,
/// the odds. Once the frame is tracked, its pose is settled: as tracked, unless the room says
/// otherwise. Thread: one. Deterministic.
class MotionEvidence {
 public:
  MotionEvidence(const EvidenceOptions& options, const Camera& camera);

  /// The odds in the next frame. `features` are all that were extracted.
  const MotionOdds& look(std::shared_ptr<const Features> features, const DepthImage& depth_m,
                         Timestamp stamp);

  /// The frame that was looked at last is tracked: the camera's motion since the frame before;
  /// none: tracking is lost, and the evidence's own motion has to do. `prior` are log-odds that a
  /// cell moves by the class of what was detected there; empty: nothing was.
  void settle(const std::optional<SE3>& T_now_last, std::vector<float> prior);

  /// The same, but its depth or its pose is doubted: it is no witness, and what was known before it
  /// stays what is known.
  void withhold(const std::optional<SE3>& T_now_last);

  const MotionOdds& odds() const { return odds_; }
  void clear();

 private:
  struct Seen {
    Timestamp stamp;
    std::shared_ptr<const Features> features;
    CoarseDepth depth;
    SE3 T_origin_camera;
  };
  /// In the tracked motion against the best one, as share of its support.
  double trust() const;
  SE3 predicted_pose(Timestamp stamp) const;
  const Seen& nearest_age(Timestamp stamp, double age_s) const;
  std::vector<const Seen*> witnesses() const;
  std::vector<int> pieces_of(std::span<const FeaturePair> pairs) const;
  PairedPieces paired(const Seen& then, const SE3& T_origin_now) const;
  std::vector<float> piece_weights() const;
  void set_excess(const SE3& T_origin_now);
  /// The odds with the frame standing there.
  void judge(const SE3& T_origin_now);
  void gather_space(std::span<float> gathered) const;
  void gather_motions(const Seen& then, const PairedPieces& pieces,
                      std::span<float> gathered) const;
  void conclude(std::span<const float> gathered);
  /// The frame stood there.
  void move_on(const SE3& T_origin_now);
  void remember();

  EvidenceOptions options_;
  Camera camera_;
  std::vector<Eigen::Vector2f> rays_;
  std::deque<Seen> seen_;                    ///< oldest first
  std::optional<SE3> T_now_last_;            ///< velocity, ...
  double interval_s_ = 0;                    ///< ... over this time, ...
  SE3 T_origin_last_;                        ///< ... up to this pose, of the last frame, ...
  Timestamp last_stamp_;                     ///< ... which need not be among those seen
  std::optional<Seen> now_;                  ///< looked at, not settled
  PointList points_;                         ///< of its cells, in its camera frame
  Surfaces surfaces_;                        ///< of now
  KeypointGrid grid_;                        ///< of its features
  std::optional<PairedPieces> pieces_;       ///< of now and an earlier frame
  const Seen* earlier_ = nullptr;            ///< that one
  std::optional<PairedPieces> last_pieces_;  ///< of now and the last frame, if that is another
  std::vector<float> weight_;                ///< of pieces
  MotionOdds before_;                        ///< of the newest frame seen
  MotionOdds carried_;                       ///< what was known of now before it was looked at
  MotionOdds odds_;                          ///< of now
  double excess_ = 1;                        ///< of the sensor's residuals over its noise model
  unsigned frames_ = 0;
};

}  // namespace ydd
