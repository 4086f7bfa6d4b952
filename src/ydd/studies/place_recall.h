// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "ydd/loop/loop_closer.h"
#include "ydd/map/atlas.h"

namespace ydd {

/// A keyframe with the pose that it really had.
struct Place {
  KeyFrameId id;
  SE3 T_true_camera;
};

/// How often a place is recognised, by similarity alone and verified.
struct PlaceCounts {
  int queries = 0;            ///< keyframes of a place that was seen long before
  int strangers = 0;          ///< keyframes of a place that was not
  std::vector<double> right;  ///< scores of best candidates that are the place
  std::vector<double> wrong;  ///< and of those that are not
  int verified_right = 0, verified_wrong = 0;

  double top1_recall() const { return share(static_cast<int>(right.size())); }
  /// Share of the revisits above the best score of a wrong answer.
  double recall_at_full_precision() const {
    const double limit = wrong.empty() ? 0.0 : *std::max_element(wrong.begin(), wrong.end());
    return share(static_cast<int>(
        std::count_if(right.begin(), right.end(), [&](double score) { return score > limit; })));
  }
  double share(int n) const { return queries == 0 ? 0.0 : static_cast<double>(n) / queries; }
};

/// Asks for each place among those that are more than `apart_s` past (less, and it would only be
/// the next moment of the same look), as a loop is looked for. The same place is what lies within
/// 0.6 m and 20 degrees.
void count_places(const Atlas& atlas, const std::vector<Place>& places, const LoopOptions& options,
                  PlaceCounts& counts, double apart_s = 6.0);

}  // namespace ydd
