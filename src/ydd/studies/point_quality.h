// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ydd/detection/detection.h"
#include "ydd/dynamics/filtered_features.h"
#include "ydd/image/image.h"

namespace ydd {

/// How well points were judged against a mask of what moves; counts of points, to be summed over
/// frames.
struct PointQuality {
  int moving = 0;               ///< points on what moves
  int moving_rejected = 0;      ///< of these rejected
  int stationary = 0;           ///< points on what does not
  int stationary_rejected = 0;  ///< of these rejected
  int in_person = 0;            ///< static points inside a person box
  int in_person_kept = 0;       ///< of these kept
  int inner = 0;                ///< of `in_person` those farther than 3 px from what moves
  int inner_kept = 0;           ///< of these kept

  PointQuality& operator+=(const PointQuality& other);
  int rejected() const { return moving_rejected + stationary_rejected; }
  /// Share of the moving points that were rejected; 1 without any.
  double recall() const;
  /// Share of the rejected points that move; 1 without any.
  double precision() const;
  /// Share of the static points inside person boxes that were kept; 1 without any.
  double kept_in_persons() const;
  /// The same without points at silhouettes, which the edge rule is meant to reject.
  double kept_off_silhouettes() const;
};

/// Counts one frame. `rules` has an entry for each keypoint; a pixel of `moving` above 0 moves, and
/// a keypoint counts by the pixel nearest to it (outside the mask: static). `persons` are the boxes
/// of persons.
PointQuality point_quality(const std::vector<Rule>& rules, const std::vector<Keypoint>& keypoints,
                           const Image<std::uint8_t>& moving, const std::vector<Box>& persons);

}  // namespace ydd
