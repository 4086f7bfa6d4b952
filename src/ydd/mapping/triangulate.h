// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/matching/projection_search.h"

namespace ydd {

/// When two views make a point; describe() has the sentences.
struct TriangulationOptions {
  int neighbours = 5;
  double min_baseline_m = 0.05;
  double min_parallax_cosine = 0.9998;
  double epipolar_chi2 = 3.84;
  void describe(OptionTable& table);
};

/// Creates points from keypoints that have no point yet in the keyframe and in one of its
/// neighbours: matched by descriptor along the epipolar line, placed by triangulation or by the
/// depth of either, and accepted when the reprojection in both agrees. Serves mostly what is beyond
/// the depth sensor's range. Gives the new points.
std::vector<MapPointId> triangulate_with_neighbours(Atlas& atlas, KeyFrameId keyframe,
                                                    const TriangulationOptions& options,
                                                    const MatchLimits& limits);

}  // namespace ydd
