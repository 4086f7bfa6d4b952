// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ydd/dynamics/body_matching.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/dynamics/point_rules.h"

namespace ydd {

/// What the rules look at: one frame's objects and what was measured of them.
struct Scene {
  std::vector<SceneObject> objects;  ///< the detections that are not static, with their depths
  std::vector<Body> bodies;          ///< persons with the head and hands that were matched to them
  DepthExtents extents;              ///< of the object catalogue, metres
  DepthImage depth_m;                ///< of the frame, metres; 0: no reading
};

/// Measures depths and matches heads and hands to persons: sections 3 and 4 of docs/method.md.
Scene make_scene(const Detections& detections, const ObjectCatalogue& catalogue,
                 const DepthImage& depth_m, const DynamicsOptions& options);

/// A person in variant `full`: rejected as a whole when its box is small or entangled or its depth
/// has failed (section 8), else by the body's depth range (section 5). With `entangled_by_head` an
/// entangled person with a head of its own is judged by depth all the same.
MovingRegion body_region(const Scene& scene, const Body& body, const DynamicsOptions& options);

/// A person in variant `person`: by the body's depth range; as a whole when the depth has failed.
MovingRegion person_region(const Scene& scene, const Body& body, const DynamicsOptions& options);

/// An automatic object: as a whole when its box is small or its depth has failed, else by its
/// range.
MovingRegion automatic_region(const Scene& scene, int object, const DynamicsOptions& options);

/// A potentially dynamic object: nothing while it is static; by its range when it is moved; as a
/// whole when its depth has failed although a hand or a body with hidden hands is near (with
/// `spare_unmeasured` only a hand).
std::optional<MovingRegion> moved_region(const Scene& scene, int object,
                                         const DynamicsOptions& options);

/// The surroundings of a hand: the box scaled, at `[D + hand/2 - small, D + hand/2 + small]`
/// (article, equation 12). A hand without depth: its own box as a whole.
MovingRegion hand_region(const Scene& scene, int object, const DynamicsOptions& options);

/// A head or hand that belongs to no person (beyond the article): by `[D - allowance * d, D + d]`
/// in its own box, as a whole when its depth has failed.
MovingRegion lone_part_region(const Scene& scene, int object, const DynamicsOptions& options);

/// The persons of a frame, one region each, in the order of the bodies; of variant `off` none. In
/// variant `full` with `hidden_bodies` the range of an overlapping person without a head takes in
/// what the other persons leave of its box, instead of a full rejection where it was entangled.
std::vector<MovingRegion> body_regions(const Scene& scene, const DynamicsOptions& options);

/// Everything else that moves, variant `full` only: automatic objects, moved objects, lone parts,
/// surroundings of hands, in this order.
std::vector<MovingRegion> thing_regions(const Scene& scene, const DynamicsOptions& options);

}  // namespace ydd
