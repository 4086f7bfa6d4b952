// SPDX-License-Identifier: Apache-2.0
#include "ydd/window/map_view.h"

#include <utility>

#include "ydd/base/timing.h"

namespace ydd {
namespace {

constexpr std::int64_t kRenewEvery_ns = 150'000'000;
constexpr double kTopPitch_rad = 1.55;
constexpr double kFirstYaw_rad = 0.6;
constexpr double kFirstPitch_rad = 0.5;
constexpr double kDistance = 1.5;  // of the map's radius

}  // namespace

void MapView::show(std::shared_ptr<const LiveFrame> live, const LiveScene& scene,
                   const ViewState& state) {
  live_ = std::move(live);
  if (live_->status.resets != resets_) {
    resets_ = live_->status.resets;
    cloud_.clear();
    patches_.clear();
    renewed_ns_ = 0;
  }
  current_ = build_current_scene(*live_, scene.camera, scene_.up);
  layers_.seen_points.upload(current_.seen_points);
  layers_.camera.upload(current_.camera);
  layers_.tracks.upload(current_.tracks);
  if (state.dense) collect_dense(scene);
  const std::int64_t now_ns = wall_clock_ns();
  stale_ = !live_->status.finished && now_ns - renewed_ns_ < kRenewEvery_ns;
  if (stale_) return;
  renewed_ns_ = now_ns;
  renew(scene);
}

void MapView::renew(const LiveScene& scene) {
  scene_ = build_map_scene(*live_, scene.groundtruth);
  layers_.points.upload(std::exchange(scene_.points, {}));
  layers_.keyframes.upload(std::exchange(scene_.keyframes, {}));
  layers_.covisibility.upload(std::exchange(scene_.covisibility, {}));
  layers_.loops.upload(scene_.loops);
  layers_.trajectory.upload(std::exchange(scene_.trajectory, {}));
  layers_.truth.upload(std::exchange(scene_.truth, {}));
  layers_.errors.upload(std::exchange(scene_.errors, {}));
  layers_.grid.upload(std::exchange(scene_.grid, {}));
}

void MapView::collect_dense(const LiveScene& scene) {
  if (!cloud_.add(*live_, scene.camera)) return;
  if (patches_.size() == DenseCloud::kMostPatches) patches_.erase(patches_.begin());
  const DensePatch& fresh = cloud_.patches().back();
  patches_.push_back(std::make_unique<Patch>());
  patches_.back()->reference = fresh.reference;
  patches_.back()->T_reference_camera = fresh.T_reference_camera;
  patches_.back()->points.upload(fresh.points);
}

bool MapView::animate(EyeMode mode, double elapsed_s) {
  if (!current_.T_world_camera) return false;
  // Between the camera and the middle of what it has seen: both stay in the picture.
  const Eigen::Vector3d target = 0.5 * (current_.T_world_camera->translation() + scene_.centre);
  const double distance_m = kDistance * scene_.radius_m;
  if (!placed_) {
    eye_.look_at(target);
    eye_.set_up(scene_.up);
    eye_.set_angles(kFirstYaw_rad, kFirstPitch_rad);
    eye_.set_distance(distance_m);
    placed_ = true;
    return true;
  }
  if (mode == EyeMode::free) return false;
  const Eigen::Vector3d before = eye_.eye();
  eye_.approach(target, scene_.up, elapsed_s);
  if (!zoomed_) eye_.approach_distance(distance_m, elapsed_s);
  if (mode == EyeMode::top) eye_.set_angles(eye_.yaw_rad(), kTopPitch_rad);
  return (eye_.eye() - before).norm() > 1e-3 * eye_.distance_m();
}

void MapView::turn(double dx_px, double dy_px) { eye_.orbit(dx_px, dy_px); }

void MapView::zoom(double steps) {
  eye_.zoom(steps);
  zoomed_ = zoomed_ || steps != 0;
}

void MapView::pan(double dx_px, double dy_px, double height_px) {
  eye_.pan(dx_px, dy_px, height_px);
}

void MapView::fit() {
  eye_.fit(scene_.centre, scene_.radius_m);
  zoomed_ = false;
}

void MapView::draw(const gl::Viewport& viewport, const ViewState& state) {
  const double aspect = static_cast<double>(viewport.width) / viewport.height;
  const Eigen::Matrix4d clip_from_world = eye_.projection(aspect) * eye_.T_eye_world();
  painter_.begin(viewport);
  if (state.grid) painter_.lines(layers_.grid, clip_from_world, 1);
  if (state.dense) draw_dense(clip_from_world);
  if (state.points) painter_.points(layers_.points, clip_from_world, 3);
  if (state.covisibility) painter_.lines(layers_.covisibility, clip_from_world, 1);
  if (state.keyframes) painter_.lines(layers_.keyframes, clip_from_world, 1);
  if (state.points) painter_.points(layers_.seen_points, clip_from_world, 4);
  painter_.on_top();
  if (state.errors) painter_.lines(layers_.errors, clip_from_world, 1.5F);
  // Truth is a pale band with the estimate inside while they agree.
  if (state.truth) painter_.lines(layers_.truth, clip_from_world, 6);
  if (state.trajectory) painter_.lines(layers_.trajectory, clip_from_world, 2.5F);
  if (state.loops) painter_.lines(layers_.loops, clip_from_world, 3);
  if (state.tracks) painter_.lines(layers_.tracks, clip_from_world, 2);
  painter_.lines(layers_.camera, clip_from_world, 2.5F);
  painter_.end();
}

std::vector<MapView::PlacedLabel> MapView::labels(double aspect) const {
  std::vector<PlacedLabel> out;
  const Eigen::Matrix4d clip_from_world = eye_.projection(aspect) * eye_.T_eye_world();
  for (const SceneLabel& label : current_.labels) {
    const Eigen::Vector4d clip = clip_from_world * label.p_world.homogeneous();
    if (clip.w() <= 0) continue;  // behind the eye
    out.push_back({&label, 0.5 + 0.5 * clip.x() / clip.w(), 0.5 - 0.5 * clip.y() / clip.w()});
  }
  return out;
}

void MapView::draw_dense(const Eigen::Matrix4d& clip_from_world) {
  for (const auto& patch : patches_) {
    const auto T_world_reference = live_->atlas->T_world_keyframe(patch->reference);
    if (!T_world_reference) continue;
    const SE3 T_world_camera = *T_world_reference * patch->T_reference_camera;
    painter_.points(patch->points, clip_from_world * T_world_camera.matrix(), 3);
  }
}

}  // namespace ydd
