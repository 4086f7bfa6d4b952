// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/object_depth.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace ydd {
namespace {

struct Centre {
  float x_px, y_px;
};

Centre centre_of(const Box& box) { return {(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2}; }

/// The valid readings of one arm, from the centre outward in steps of (dx, dy).
std::vector<float> arm_readings(const DepthImage& depth_m, Centre centre, float dx_px, float dy_px,
                                int samples) {
  std::vector<float> readings;
  readings.reserve(static_cast<std::size_t>(samples));
  for (int i = 1; i <= samples; ++i) {
    const auto k = static_cast<float>(i);
    const float d = depth_at(depth_m, centre.x_px + k * dx_px, centre.y_px + k * dy_px);
    if (d > 0.0F) readings.push_back(d);
  }
  return readings;
}

float mean_of(std::span<const float> values) {
  return std::accumulate(values.begin(), values.end(), 0.0F) / static_cast<float>(values.size());
}

/// Mean of the nearest readings of the arm that is nearer on average.
std::optional<float> nearer_arm(std::vector<float> a, std::vector<float> b, int nearest_samples) {
  if (a.empty() && b.empty()) return std::nullopt;
  std::vector<float>& arm = b.empty() || (!a.empty() && mean_of(a) <= mean_of(b)) ? a : b;
  std::sort(arm.begin(), arm.end());
  const auto n = std::min(arm.size(), static_cast<std::size_t>(nearest_samples));
  return mean_of(std::span(arm).first(n));
}

}  // namespace

float depth_at(const DepthImage& depth_m, float x_px, float y_px) {
  const auto x = static_cast<int>(std::lround(x_px));
  const auto y = static_cast<int>(std::lround(y_px));
  if (!depth_m.contains(x, y)) return 0.0F;
  const float d = depth_m(x, y);
  return std::isfinite(d) && d > 0.0F ? d : 0.0F;
}

std::optional<float> centre_depth(const DepthImage& depth_m, const Box& box,
                                  const ObjectDepthOptions& options) {
  const Centre centre = centre_of(box);
  const int r = options.head_window_px;
  int best_distance2 = 2 * r * r + 1;
  float best_m = 0;
  for (int dy = -r; dy <= r; ++dy) {
    for (int dx = -r; dx <= r; ++dx) {
      const int distance2 = dx * dx + dy * dy;
      if (distance2 > best_distance2) continue;
      const float d = depth_at(depth_m, centre.x_px + static_cast<float>(dx),
                               centre.y_px + static_cast<float>(dy));
      if (d <= 0.0F || (distance2 == best_distance2 && d >= best_m)) continue;
      best_distance2 = distance2;
      best_m = d;
    }
  }
  return best_m > 0.0F ? std::optional(best_m) : std::nullopt;
}

std::optional<float> cross_depth(const DepthImage& depth_m, const Box& box,
                                 const ObjectDepthOptions& options) {
  const Centre c = centre_of(box);
  const int n = options.arm_samples;
  const auto share = static_cast<float>(options.arm_share / n);
  const float dx = box.width() * share;
  const float dy = box.height() * share;
  const auto horizontal = nearer_arm(arm_readings(depth_m, c, -dx, 0, n),
                                     arm_readings(depth_m, c, dx, 0, n), options.nearest_samples);
  const auto vertical = nearer_arm(arm_readings(depth_m, c, 0, -dy, n),
                                   arm_readings(depth_m, c, 0, dy, n), options.nearest_samples);
  if (!horizontal || !vertical) return horizontal ? horizontal : vertical;
  return std::min(*horizontal, *vertical);
}

std::vector<SceneObject> measure_objects(const Detections& detections,
                                         const ObjectCatalogue& catalogue,
                                         const DepthImage& depth_m,
                                         const ObjectDepthOptions& options) {
  std::vector<SceneObject> objects;
  objects.reserve(detections.size());
  for (std::size_t i = 0; i < detections.size(); ++i) {
    const Detection& detection = detections[i];
    SceneObject object;
    object.subcategory = catalogue.subcategory_of(detection.class_name);
    if (object.subcategory == Subcategory::stationary) continue;
    object.detection = static_cast<int>(i);
    object.box = detection.box;
    object.extent_m = catalogue.extent_m(detection.class_name);
    object.depth_m = object.subcategory == Subcategory::head
                         ? centre_depth(depth_m, object.box, options)
                         : cross_depth(depth_m, object.box, options);
    objects.push_back(object);
  }
  return objects;
}

}  // namespace ydd
