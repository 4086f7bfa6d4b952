// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ydd/viewer/dense_cloud.h"
#include "ydd/viewer/map_scene.h"
#include "ydd/viewer/orbit_camera.h"
#include "ydd/window/gl_draw.h"
#include "ydd/window/view_state.h"

namespace ydd {

/// The map in 3-D: keeps its vertices on the graphics card, and renews them only when the map or
/// the trajectory has changed, a few times a second at most. Thread: the window's.
class MapView {
 public:
  /// Takes a newer frame over.
  void show(std::shared_ptr<const LiveFrame> live, const LiveScene& scene, const ViewState& state);
  /// True while the scene on the card is older than the frame shown.
  bool stale() const { return stale_; }
  /// Moves the eye on; true while it still moves.
  bool animate(EyeMode mode, double elapsed_s);
  void draw(const gl::Viewport& viewport, const ViewState& state);

  void turn(double dx_px, double dy_px);
  /// From then on the distance is the user's affair, until `fit`.
  void zoom(double steps);
  void pan(double dx_px, double dy_px, double height_px);
  void fit();
  /// Counters of what is drawn; its vertices are on the card and no longer here.
  const MapScene& scene() const { return scene_; }

  /// A label and where it belongs in the picture of the map, as shares of its width and height from
  /// the upper left corner.
  struct PlacedLabel {
    const SceneLabel* label;
    double x = 0, y = 0;
  };
  /// Those in sight. Valid until the next `show`.
  std::vector<PlacedLabel> labels(double aspect) const;

 private:
  struct Layers {
    gl::VertexBuffer points, keyframes, covisibility, loops, trajectory, truth, errors, grid;
    gl::VertexBuffer seen_points, camera, tracks;
  };
  struct Patch {
    KeyFrameId reference;
    SE3 T_reference_camera;
    gl::VertexBuffer points;
  };
  void renew(const LiveScene& scene);
  void collect_dense(const LiveScene& scene);
  void draw_dense(const Eigen::Matrix4d& clip_from_world);

  std::shared_ptr<const LiveFrame> live_;
  MapScene scene_;
  CurrentScene current_;
  DenseCloud cloud_;
  std::vector<std::unique_ptr<Patch>> patches_;
  OrbitCamera eye_;
  gl::Painter painter_;
  Layers layers_;
  std::int64_t renewed_ns_ = 0;
  int resets_ = 0;
  bool stale_ = false;
  bool placed_ = false;  ///< the eye has found its first place
  bool zoomed_ = false;  ///< the user has chosen the distance
};

}  // namespace ydd
