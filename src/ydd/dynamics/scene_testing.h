// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "ydd/detection/detection.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/features/features.h"
#include "ydd/image/image.h"

namespace ydd::scene_testing {

/// A hand-made scene: a depth image of painted rectangles, boxes, and points.
class PaintedScene {
 public:
  explicit PaintedScene(float background_m = 4.0F)
      : depth_(static_cast<std::size_t>(kWidth) * kHeight, background_m) {}

  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;

  PaintedScene& paint(const Box& box, float depth_m) {
    for (int y = first(box.y0); y < first(box.y1) && y < kHeight; ++y) {
      for (int x = first(box.x0); x < first(box.x1) && x < kWidth; ++x) {
        depth_[static_cast<std::size_t>(y) * kWidth + x] = depth_m;
      }
    }
    return *this;
  }
  PaintedScene& detect(std::string class_name, const Box& box) {
    detections_.push_back({std::move(class_name), 0.9F, box});
    return *this;
  }
  /// A thing that fills its box.
  PaintedScene& thing(const std::string& class_name, const Box& box, float depth_m) {
    return paint(box, depth_m).detect(class_name, box);
  }

  DepthImage depth() const { return {kWidth, kHeight, depth_}; }
  const Detections& detections() const { return detections_; }

  /// Features at these pixels with the painted depth.
  Features points(const std::vector<std::pair<float, float>>& pixels) const {
    const DepthImage image = depth();
    Features features;
    for (const auto& [x, y] : pixels) {
      features.keypoints.push_back({x, y, 0, 1, 0});
      features.descriptors.push_back({});
      features.undistorted_px.emplace_back(x, y);
      features.depth_m.push_back(image(static_cast<int>(x), static_cast<int>(y)));
      features.right_px.push_back(-1);
    }
    return features;
  }

 private:
  static int first(float px) { return std::max(0, static_cast<int>(std::lround(px))); }
  std::vector<float> depth_;
  Detections detections_;
};

/// Exactly the article's rules.
inline DynamicsOptions article_options() {
  DynamicsOptions options;
  options.refinement.enabled = false;
  return options;
}

}  // namespace ydd::scene_testing
