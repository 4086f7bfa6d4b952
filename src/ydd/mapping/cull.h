// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/map/atlas.h"
#include "ydd/matching/keyframe_candidate.h"

namespace ydd {

/// Which points and keyframes go; describe() has the sentences.
struct CullOptions {
  double min_found_ratio = 0.25;
  int probation_keyframes = 2;
  int contradicted_frames = 15;
  int min_observations = 2;
  double redundant_share = 0.9;
  int redundant_observations = 3;
  int place_keyframes = 3;
  double place_radius_m = 0.35;
  double place_rotation_rad = 0.26;
  double close_depth_m = 3.0;  ///< SystemOptions sets it
  double revisit_s = 60.0;     ///< SystemOptions sets it
  void describe(OptionTable& table);
};

/// Removes points on probation that tracking rarely finds or that too few keyframes saw; takes
/// those off the list that passed. Gives how many went.
int cull_recent_points(Atlas& atlas, std::vector<MapPointId>& recent, KeyFrameId newest,
                       const CullOptions& options);

/// Removes points that stand where the camera has looked through, or on what moves, for so many
/// frames in which they should have been seen (tracking counts them in variant `evidence`). Gives
/// how many went.
int cull_contradicted_points(Atlas& atlas, std::span<const PointViews> views,
                             const CullOptions& options);

/// Removes keyframes around `newest` most of whose near points at least three others see at the
/// same or a finer scale. Gives how many went.
int cull_redundant_keyframes(Atlas& atlas, KeyFrameId newest, const CullOptions& options);

/// Where places are seen again: keeps the number of keyframes around `newest` that look its way to
/// `place_keyframes`, by removing those of earlier visits whose points are found least, for how
/// often they should be, and have most other witnesses. Keyframes of this visit stay: what they are
/// worth is not known yet. Does nothing where all keyframes are of one visit. Gives how many went.
///
/// A budget for a place that the most often matched share, whatever light they saw it in, is the
/// idea of summary maps: Muehlfellner, Buerki, Bosse, Derendarz, Philippsen and Furgale, "Summary
/// maps for lifelong visual localization", Journal of Field Robotics 2016.
int cull_crowded_place(Atlas& atlas, KeyFrameId newest, const CullOptions& options);

}  // namespace ydd
