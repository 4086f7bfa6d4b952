// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ydd/detection/detection.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/image/image.h"

namespace ydd {

/// The reading at the pixel nearest to (x, y); 0 outside the image and where there is none.
float depth_at(const DepthImage& depth_m, float x_px, float y_px);

/// Depth at the box centre; where there is no reading, the nearest one in the window of
/// `head_window_px` round it (of equally near ones the nearer to the camera).
std::optional<float> centre_depth(const DepthImage& depth_m, const Box& box,
                                  const ObjectDepthOptions& options);

/// Approximate minimum depth from a cross of samples through the box centre: of the left and the
/// right arm the one with the smaller mean gives the mean of its three nearest readings, likewise
/// above and below, and the smaller of the two is the depth (article, section 3.3.1). Sides are
/// compared by means, not sums, so that holes do not decide. Nothing without any reading.
std::optional<float> cross_depth(const DepthImage& depth_m, const Box& box,
                                 const ObjectDepthOptions& options);

/// Median of readings on a grid over the inner part of `box`, leaving out what lies in one of
/// `covers`. Nothing when no reading is left.
std::optional<float> uncovered_depth(const DepthImage& depth_m, const Box& box,
                                     std::span<const Box> covers);

/// A detection that is not static, with its depth measured.
struct SceneObject {
  int detection = -1;  ///< index into the detections
  Subcategory subcategory = Subcategory::stationary;
  Box box;
  double extent_m = 0;
  std::optional<float> depth_m;  ///< none: its depth failed
  GreyImage mask = {};           ///< as Detection::mask
};

/// Looks up and measures every detection that is not static, in the order given: heads at their
/// centre, everything else by the cross. With `uncovered_heads` a head whose centre lies behind the
/// box of a hand or a small object is measured where it is not covered (beyond the article).
std::vector<SceneObject> measure_objects(const Detections& detections,
                                         const ObjectCatalogue& catalogue,
                                         const DepthImage& depth_m,
                                         const ObjectDepthOptions& options,
                                         bool uncovered_heads = false);

}  // namespace ydd
