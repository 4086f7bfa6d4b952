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

bool any_contains(std::span<const Box> boxes, float x_px, float y_px) {
  return std::any_of(boxes.begin(), boxes.end(),
                     [&](const Box& box) { return box.contains(x_px, y_px); });
}

/// The boxes of things that a person may hold before a face.
std::vector<Box> covering_boxes(std::span<const SceneObject> objects) {
  std::vector<Box> boxes;
  for (const SceneObject& object : objects) {
    if (object.subcategory == Subcategory::hand || object.subcategory == Subcategory::small) {
      boxes.push_back(object.box);
    }
  }
  return boxes;
}

std::optional<float> head_depth(const DepthImage& depth_m, const Box& head,
                                std::span<const Box> covers, const ObjectDepthOptions& options) {
  const Centre centre = centre_of(head);
  if (any_contains(covers, centre.x_px, centre.y_px)) {
    if (const auto depth = uncovered_depth(depth_m, head, covers)) return depth;
  }
  return centre_depth(depth_m, head, options);
}

}  // namespace

float depth_at(const DepthImage& depth_m, float x_px, float y_px) {
  // Half a pixel and floor: one instruction, where lround is a call.
  const auto x = static_cast<int>(std::floor(x_px + 0.5F));
  const auto y = static_cast<int>(std::floor(y_px + 0.5F));
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

std::optional<float> uncovered_depth(const DepthImage& depth_m, const Box& box,
                                     std::span<const Box> covers) {
  constexpr int kSteps = 9;         // each way
  constexpr float kMargin = 0.15F;  // the corners of a head's box show what is behind it
  std::vector<float> readings;
  for (int row = 0; row < kSteps; ++row) {
    for (int column = 0; column < kSteps; ++column) {
      const auto share = [](int k) {
        return kMargin + (1 - 2 * kMargin) * static_cast<float>(k) / (kSteps - 1);
      };
      const float x = box.x0 + share(column) * box.width();
      const float y = box.y0 + share(row) * box.height();
      const float d = depth_at(depth_m, x, y);
      if (d <= 0.0F || any_contains(covers, x, y)) continue;
      readings.push_back(d);
    }
  }
  if (readings.empty()) return std::nullopt;
  const auto middle = readings.begin() + static_cast<std::ptrdiff_t>(readings.size() / 2);
  std::nth_element(readings.begin(), middle, readings.end());
  return *middle;
}

std::vector<SceneObject> measure_objects(const Detections& detections,
                                         const ObjectCatalogue& catalogue,
                                         const DepthImage& depth_m,
                                         const ObjectDepthOptions& options, bool uncovered_heads) {
  std::vector<SceneObject> objects;
  objects.reserve(detections.size());
  for (std::size_t i = 0; i < detections.size(); ++i) {
    const Detection& detection = detections[i];
    SceneObject object;
    object.subcategory = catalogue.subcategory_of(detection.class_name);
    if (object.subcategory == Subcategory::stationary) continue;
    object.detection = static_cast<int>(i);
    object.box = detection.box;
    object.mask = detection.mask;
    object.extent_m = catalogue.extent_m(detection.class_name);
    objects.push_back(object);
  }
  const std::vector<Box> covers = uncovered_heads ? covering_boxes(objects) : std::vector<Box>();
  for (SceneObject& object : objects) {
    object.depth_m = object.subcategory == Subcategory::head
                         ? head_depth(depth_m, object.box, covers, options)
                         : cross_depth(depth_m, object.box, options);
  }
  return objects;
}

}  // namespace ydd
