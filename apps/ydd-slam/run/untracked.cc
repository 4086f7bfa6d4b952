// SPDX-License-Identifier: Apache-2.0
#include "run/untracked.h"

#include <algorithm>

#include <fmt/format.h>

#include "ydd/image/decode.h"

namespace ydd::app {
namespace {

/// Less between the darkest and the brightest pixel is noise, not a picture.
constexpr int kLeastContrast = 12;

int contrast(const GreyImage& grey) {
  const std::size_t n =
      static_cast<std::size_t>(grey.width()) * static_cast<std::size_t>(grey.height());
  const auto [darkest, brightest] = std::minmax_element(grey.data(), grey.data() + n);
  return n == 0 ? 0 : *brightest - *darkest;
}

bool has_reading(const DepthImage& depth_m) {
  const std::size_t n =
      static_cast<std::size_t>(depth_m.width()) * static_cast<std::size_t>(depth_m.height());
  return std::any_of(depth_m.data(), depth_m.data() + n, [](float z) { return z > 0; });
}

}  // namespace

void Untracked::add(const RgbdFrame& frame, const FrameReport& report) {
  tracked_ = tracked_ || report.track.state == TrackingState::tracking;
  if (tracked_) return;
  if (first_ < 0) first_ = frame.index;
  ++frames_;
  if (contrast(frame.grey) < kLeastContrast) ++dark_;
  if (!has_reading(frame.depth_m)) ++without_depth_;
  const auto& depth_m = report.filtered->kept->depth_m;
  const auto points = static_cast<std::size_t>(
      std::count_if(depth_m.begin(), depth_m.end(), [](float z) { return z > 0; }));
  most_points_ = std::max(most_points_, points);
  most_rejected_ = std::max(most_rejected_, report.filtered->rejected.size());
}

std::string Untracked::depth_reason() const {
  if (sequence_.is_live()) {
    return fmt::format("no reading of depth lies within {:g} to {:g} m", camera_.min_depth_m,
                       camera_.max_depth_m);
  }
  const auto raw = sequence_.read_depth_counts(static_cast<std::size_t>(first_));
  int nearest = 0;
  if (raw) {
    const std::size_t n =
        static_cast<std::size_t>(raw->width()) * static_cast<std::size_t>(raw->height());
    for (std::size_t i = 0; i < n; ++i) {
      const int count = raw->data()[i];
      if (count > 0 && (nearest == 0 || count < nearest)) nearest = count;
    }
  }
  if (nearest == 0) return "the depth images hold no reading";
  return fmt::format(
      "no reading of frame {} lies within {:g} to {:g} m: the nearest is {:g} m at depth scale "
      "{:g}; "
      "is the camera's depth_scale (DepthMapFactor) right? Many recordings have 1000 or 5000",
      first_, camera_.min_depth_m, camera_.max_depth_m, nearest / camera_.depth_scale,
      camera_.depth_scale);
}

std::string Untracked::reason() const {
  if (dark_ == frames_) return "all pictures are dark or of one colour";
  if (without_depth_ == frames_) return depth_reason();
  if (in_known_map_) {
    return "not one frame was found in the map; is it of this place, and the camera's height and "
           "light not too different?";
  }
  if (most_rejected_ > 2 * most_points_) {
    return fmt::format(
        "nearly all points lie on what may move (at most {} others with depth in a "
        "frame); see --dynamic and --objects",
        most_points_);
  }
  return fmt::format(
      "too few keypoints with depth to start a map (at most {} in a frame); is there "
      "texture, light and depth in the pictures, and is the picture large enough?",
      most_points_);
}

}  // namespace ydd::app
