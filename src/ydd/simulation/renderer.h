// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ydd/geometry/camera.h"
#include "ydd/simulation/scene.h"

namespace ydd::sim {

/// What the ray through a pixel's centre meets.
struct RenderedPixel {
  float depth_m = 0;    ///< along the optical axis, exact; 0: nothing (outside of the world)
  int object = -1;      ///< index into Scene::objects
  bool moving = false;  ///< belongs to an actor
  bool lit_by_projector = true;
  /// Cosine between the surface normal and the line of sight.
  float facing = 1;
};

/// A picture as it is before the sensor: row by row.
struct Rendering {
  std::vector<Eigen::Array3f> colours;  ///< BGR, 255 is white, filtered over the pixel's area
  std::vector<RenderedPixel> pixels;
};

/// How finely is rendered.
struct RenderOptions {
  int edge_samples = 4;
  int threads = 1;  ///< 0: all cores; pictures do not depend on it
  /// Where the depth sensor's projector sits in the camera frame; traced when `projector` is set.
  bool projector = false;
  Vector3 projector_camera_m = Vector3::Zero();
};

/// Ray-casts a scene. Light on fixed surfaces (lamps with soft shadows, ambient occlusion) is
/// computed once at construction; what moves is lit without shadows. Thread: `render` may run
/// concurrently.
class Renderer {
 public:
  explicit Renderer(Scene scene);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  const Scene& scene() const;
  /// The camera must have no distortion; pixel centres are at integer coordinates.
  Rendering render(const Camera& camera, const SE3& T_world_camera, double time_s,
                   const RenderOptions& options) const;

 private:
  struct Impl;
  class Exposure;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace ydd::sim
