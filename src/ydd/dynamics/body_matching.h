// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ydd/dynamics/depth_range.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/dynamics/object_depth.h"

namespace ydd {

/// A person with the head and the hands that were matched to it; numbers are indices into the scene
/// objects.
struct Body {
  int person = -1;
  float coincidence = 0;   ///< largest coincidence degree with another person
  bool entangled = false;  ///< too large a degree: nothing was matched
  int head = -1;           ///< -1: none
  std::vector<int> hands;  ///< nearest in depth first where there was a choice
};

/// The head of a person. None or one head box meets the person box: that one. Of more: in the upper
/// part of a box that is taller than wide, at about the person's depth, with the top border nearest
/// to the person's; each of the first two conditions that would leave none is passed over by -1.
/// Gives -1 when none qualifies.
int match_head(std::span<const SceneObject> objects, int person,
               const BodyMatchingOptions& options);

/// The hands of a person. Up to two hand boxes meet the person box: those. Of more: those at about
/// the depth of the matched head (without one, of the person), the two nearest to it; no reference
/// depth at all: none.
std::vector<int> match_hands(std::span<const SceneObject> objects, int person, int head,
                             const BodyMatchingOptions& options);

/// One body for each person, in the order of the objects (article, section 3.3.2). A coincidence
/// degree above the limit: entangled, nothing matched; above 0: the head only; 0: head and hands.
std::vector<Body> match_bodies(std::span<const SceneObject> objects,
                               const BodyMatchingOptions& options);

/// The measured depths of a body's parts.
BodyDepths depths_of(const Body& body, std::span<const SceneObject> objects);

}  // namespace ydd
