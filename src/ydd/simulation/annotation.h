// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ydd/simulation/renderer.h"
#include "ydd/simulation/simulator.h"

namespace ydd::sim {

/// Points on every body of every actor, to see whether it moves.
class MotionProbe {
 public:
  explicit MotionProbe(const Scene& scene);
  /// Per object: does any of its parts move faster than 2 cm/s around `time_s`? A whole moves with
  /// its parts. `interval_s` is the time between frames.
  std::vector<bool> moving_objects(const Scene& scene, double time_s, double interval_s) const;
  /// Per object the middle of the bodies that it consists of, larger ones counting more, in the
  /// world; none: it is no actor. A whole has that of all its parts.
  std::vector<std::optional<Eigen::Vector3d>> middles(const Scene& scene, double time_s) const;

 private:
  struct BodyProbe {
    std::vector<Eigen::Vector3d> points_body;
    std::vector<int> objects;                               ///< that have parts on this body
    Eigen::Vector3d middle_body = Eigen::Vector3d::Zero();  ///< of the box around it
    double volume_m3 = 0;
  };
  std::vector<std::vector<BodyProbe>> actors_;
};

/// Objects that have at least `min_pixels` visible pixels, with boxes around them; wholes include
/// their parts. In the order of the scene.
std::vector<SimulatedObject> visible_objects(const Rendering& rendering, const Scene& scene,
                                             int width_px, const std::vector<bool>& moving,
                                             int min_pixels);

/// Ids of what belongs to an actor that moves at some time, 0 elsewhere.
Image<std::uint8_t> mover_mask(const Rendering& rendering, const Scene& scene,
                               const Camera& camera);

}  // namespace ydd::sim
