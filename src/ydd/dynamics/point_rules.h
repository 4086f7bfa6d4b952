// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include "ydd/detection/detection.h"
#include "ydd/dynamics/depth_range.h"
#include "ydd/dynamics/filtered_features.h"
#include "ydd/image/image.h"

namespace ydd {

/// A box in which points at some depths, or those on a mask, are on something that moves.
struct MovingRegion {
  int object = -1;                  ///< index into the scene objects
  Rule rule = Rule::kept;           ///< that rejects a point in it
  Box box;                          ///< pixels of the image as it was taken
  std::optional<DepthRange> range;  ///< none: full rejection, every point in the box goes
  std::int64_t track = -1;          ///< of the person it belongs to; -1: of none
  GreyImage mask = {};              ///< not empty: tells itself what is in it, whatever the depth

  /// Whether the pixel nearest to (x, y) is on the mask; false without one.
  bool on_mask(float x_px, float y_px) const;
};

/// An image position to be judged and its depth; 0: no reading.
struct PointSample {
  float x_px = 0;     ///< column in the image as it was taken
  float y_px = 0;     ///< row likewise
  float depth_m = 0;  ///< along the optical axis, metres; 0: no reading
};

/// The point is in the box, and on the mask; without one, the region rejects all of it or the depth
/// is in its range.
bool in_region(const MovingRegion& region, const PointSample& point);

/// The point lies in the box grown by `radius_px`, and one of the readings that far to its left,
/// right, above and below lies in the region's range (article, section 3.5.1), or on its mask.
/// Never for a full rejection, which has neither.
bool at_edge(const MovingRegion& region, const PointSample& point, const DepthImage& depth_m,
             float radius_px);

/// The next readings from a point outward: right, lower right, below, lower left, and opposite to
/// these left, upper left, above, upper right; 0: none within reach.
using Surroundings = std::array<float, 8>;
/// Of a depth image in metres, up to `reach_px` away; see Surroundings.
Surroundings surroundings_of(const PointSample& point, const DepthImage& depth_m, int reach_px);

/// The point lies in the region's box without a reading, and on at least `axes` of the four axes
/// through it the next readings to both sides lie in the region's range. Beyond the article: holes
/// on a body, such as the shadow of an arm. Never for a full rejection nor for a mask.
bool surrounded_by(const MovingRegion& region, const PointSample& point,
                   const Surroundings& surroundings, int axes);

/// What rule_of needs to know besides the regions.
struct PointRuleOptions {
  float edge_radius_px = 0;      ///< 0: edges are not asked for
  float unmeasured_edge_px = 0;  ///< the same for a point without a reading
  int surround_px = 0;           ///< 0: surroundings are not asked for
  int surround_axes = 4;         ///< of the four, that must be enclosed
};

/// The rule that decides about a point: the first region that contains it, else an edge, else its
/// surroundings, else kept.
Rule rule_of(const PointSample& point, std::span<const MovingRegion> regions,
             const DepthImage& depth_m, const PointRuleOptions& options);

}  // namespace ydd
