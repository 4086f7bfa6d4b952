// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <random>
#include <span>
#include <vector>

#include "ydd/evidence/coarse_depth.h"
#include "ydd/evidence/evidence_options.h"
#include "ydd/evidence/seen_from.h"
#include "ydd/evidence/surfaces.h"
#include "ydd/features/matching.h"
#include "ydd/geometry/se3.h"
#include "ydd/optimization/pose_only.h"

namespace ydd {

/// A feature with depth of an earlier frame, found again.
struct FeaturePair {
  int then = 0;
  int now = 0;
};

/// Looks for the features of `then` that have a depth, around where the room's motion would bring
/// them (`T_now_then`, as predicted). Of candidates that look alike the one nearest to that place
/// is taken; no feature of now is taken twice.
std::vector<FeaturePair> pair_features(const Features& then, const Features& now,
                                       const KeypointGrid& grid_now, const SE3& T_now_then,
                                       const Camera& camera, const EvidenceOptions& options);

/// Pairs of one piece of surface, which stands or moves as one.
struct PieceMotion {
  int piece = 0;
  int pairs = 0;
  double chi2 = 0;  ///< of its middle 3-D residual; 3 degrees of freedom
};

/// The pairs of two frames, by the pieces of surface that they lie on now. Thread: one.
class PairedPieces {
 public:
  PairedPieces() = default;
  /// `piece_of` gives for each pair its piece; -1: on none, left out.
  PairedPieces(const Features& then, const Features& now, std::span<const FeaturePair> pairs,
               std::span<const int> piece_of, const Camera& camera, const EvidenceOptions& options);

  /// The depth of both frames has a say besides, through every other cell of every other row of
  /// now. `then` must outlive this.
  void add_depth(const CoarseDepth& now, const Surfaces& surfaces,
                 std::span<const Eigen::Vector2f> rays, const CoarseDepth& then);

  /// How well each piece agrees with a motion of the camera alone. Pieces with fewer than
  /// three pairs are left out.
  std::vector<PieceMotion> motions(const SE3& T_now_then) const;

  /// What residuals are judged against from now on: by how much this sensor's chi-square exceeds
  /// what its noise model says (1: not at all).
  void set_excess(double excess) { excess_ = excess; }

  /// What pieces say of a motion, by weight: each agrees by how far its chi-square is below the
  /// limit of standing still. Where less than `at_least` agree, it may come back as none.
  struct Support {
    double agreeing = 0;  ///< each by how well
    double standing = 0;  ///< each that is below the limit, whole
    double total = 0;     ///< of all that can tell
    double share() const { return total > 0 ? standing / total : 0; }
  };
  Support support(const SE3& T_now_then, std::span<const float> weight, double at_least = 0) const;

  /// The motion that most weight of pieces agrees with, with some preference for motions next to
  /// `expected`. `weight` is that of each piece (by its number): what it vouches for. Four pieces
  /// at a time propose, unless nearly all agree at once. Every choice follows from `seed`.
  SE3 consensus(const SE3& expected, std::span<const float> weight, int proposals,
                unsigned seed) const;

 private:
  struct Pair {
    Eigen::Vector3d p_then, p_now;  ///< camera frames, metres; z of now 0: no reading
    Eigen::Vector2d px_now;         ///< undistorted
    double right_px = -1, sigma_px = 1, variance_m2 = 0;
  };
  struct Group {
    int piece = 0;
    std::size_t first = 0, count = 0;  ///< of the pairs
  };
  /// By how far the depth of one piece is off.
  struct DepthSum {
    float off_m = 0, variance_m2 = 0, z_m = 0;
    int count = 0;
  };
  /// What calls work in; kept between them, so that they need no memory of their own.
  struct Scratch {
    std::vector<double> du_px, dv_px, dz_m;  ///< residuals of one group
    std::vector<double> chi2;                ///< of pieces; negative: cannot tell
    std::vector<DepthSum> depth;             ///< of pieces
    SeenFrom::Places places;                 ///< of the cells, in the earlier frame
    std::vector<PoseObservation> observations;
    std::vector<int> groups;
  };
  double chi2_of(const Group& group, const SE3& T_now_then) const;
  SE3 fitted(const SE3& start, std::span<const int> groups, std::span<const float> weight) const;
  /// The groups with a say whose chi-square is below the limit; until the next call.
  std::span<const int> agreeing(const SE3& T_now_then, std::span<const float> weight,
                                double chi2_limit) const;
  /// Least squares over what agrees, as long as that loses no support.
  SE3 polished(SE3 T_now_then, std::span<const float> weight) const;
  /// The motion that four pieces, drawn by weight, agree on; none: the draw was no good.
  std::optional<SE3> proposal(const SE3& expected, std::span<const float> weight,
                              std::span<const double> reach, std::mt19937& random) const;
  void sum_depth(const SE3& T_now_then) const;
  /// Of a piece, by its depth alone; 1 degree of freedom; negative: it cannot tell.
  double depth_chi2(const DepthSum& sum) const;

  Camera camera_;
  EvidenceOptions options_;
  double excess_ = 1;
  PointList cell_points_;
  std::vector<int> cell_piece_;
  const CoarseDepth* then_depth_ = nullptr;
  int piece_count_ = 0;
  std::vector<Pair> pairs_;  ///< by piece
  std::vector<Group> groups_;
  mutable Scratch scratch_;
};

}  // namespace ydd
