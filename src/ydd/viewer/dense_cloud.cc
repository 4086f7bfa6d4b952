// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/dense_cloud.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace ydd {
namespace {

constexpr float kBoxMargin_px = 6;       // boxes cut through fingers and hair
constexpr float kRangeMargin_m = 0.08F;  // and depth smears along silhouettes
constexpr float kNearRejected_px = 14;
constexpr float kNearRejected_m = 0.25F;
constexpr double kNewView_m = 0.25;
constexpr double kNewView_rad = 0.25;

/// Where and at which depths something moves.
struct Moving {
  Box box;
  DepthRange range_m;
};

constexpr DepthRange kAnyDepth{0, 1e6F};

DepthRange widened(DepthRange range, float by_m) {
  return {range.min_m - by_m, range.max_m + by_m};
}

std::vector<Moving> moving_things(const FrameReport& report) {
  std::vector<Moving> things;
  for (const ObjectJudgement& object : report.judgement.objects) {
    if (object.rule == Rule::kept) continue;
    const Box& b = object.box;
    things.push_back(
        {{b.x0 - kBoxMargin_px, b.y0 - kBoxMargin_px, b.x1 + kBoxMargin_px, b.y1 + kBoxMargin_px},
         object.range ? widened(*object.range, kRangeMargin_m) : kAnyDepth});
  }
  for (const RejectedPoint& p : report.filtered->rejected) {
    const auto [x, y] = std::pair(p.keypoint.x_px, p.keypoint.y_px);
    things.push_back(
        {{x - kNearRejected_px, y - kNearRejected_px, x + kNearRejected_px, y + kNearRejected_px},
         p.depth_m > 0 ? widened({p.depth_m, p.depth_m}, kNearRejected_m) : kAnyDepth});
  }
  return things;
}

/// One flag for each looked-at pixel: painted thing by thing, which costs what the boxes cover.
class MovingMask {
 public:
  MovingMask(const DepthImage& depth_m, int step_px)
      : step_px_(step_px),
        width_((depth_m.width() + step_px - 1) / step_px),
        height_((depth_m.height() + step_px - 1) / step_px),
        flags_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

  void paint(const Moving& thing, const DepthImage& depth_m) {
    for (int row = cell(thing.box.y0, height_); row <= cell(thing.box.y1, height_); ++row) {
      for (int col = cell(thing.box.x0, width_); col <= cell(thing.box.x1, width_); ++col) {
        if (thing.range_m.contains(depth_m(col * step_px_, row * step_px_))) {
          flags_[index(col, row)] = true;
        }
      }
    }
  }
  bool at(int col, int row) const { return flags_[index(col, row)]; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int cell(float px, int cells) const {
    return std::clamp(static_cast<int>(px) / step_px_, 0, cells - 1);
  }
  std::size_t index(int col, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(col);
  }
  int step_px_;
  int width_, height_;
  std::vector<bool> flags_;
};

bool looks_at_something_new(const std::deque<DensePatch>& patches, const Atlas& atlas,
                            const SE3& T_world_camera) {
  return std::none_of(patches.begin(), patches.end(), [&](const DensePatch& patch) {
    const auto T_world_reference = atlas.T_world_keyframe(patch.reference);
    if (!T_world_reference) return false;
    const SE3 apart = T_world_camera.inverse() * *T_world_reference * patch.T_reference_camera;
    return apart.translation().norm() < kNewView_m && apart.angle_rad() < kNewView_rad;
  });
}

}  // namespace

Vertices static_surface(const RgbdFrame& frame, const FrameReport& report, const Camera& camera,
                        int step_px, double farthest_m) {
  MovingMask mask(frame.depth_m, step_px);
  for (const Moving& thing : moving_things(report)) mask.paint(thing, frame.depth_m);
  Vertices points;
  for (int row = 0; row < mask.height(); ++row) {
    for (int col = 0; col < mask.width(); ++col) {
      const int x = col * step_px;
      const int y = row * step_px;
      const float depth_m = frame.depth_m(x, y);
      if (depth_m <= 0 || depth_m > farthest_m || mask.at(col, row)) continue;
      const Eigen::Vector2d px = camera.undistort({x, y});
      const Eigen::Vector3f p = camera.unproject(px, depth_m).cast<float>();
      const Bgr bgr = frame.colour(x, y);
      points.push_back({{p.x(), p.y(), p.z()}, {bgr[2], bgr[1], bgr[0], 255}});
    }
  }
  return points;
}

bool DenseCloud::add(const LiveFrame& live, const Camera& camera) {
  const TrackResult& track = live.report->track;
  if (track.state != TrackingState::tracking) return false;
  const auto T_world_reference = live.atlas->T_world_keyframe(track.reference);
  if (!T_world_reference) return false;
  const SE3 T_world_camera = *T_world_reference * track.T_reference_camera;
  if (!looks_at_something_new(patches_, *live.atlas, T_world_camera)) return false;
  if (patches_.size() == kMostPatches) patches_.pop_front();
  patches_.push_back({track.reference, track.T_reference_camera,
                      static_surface(live.frame, *live.report, camera)});
  return true;
}

}  // namespace ydd
