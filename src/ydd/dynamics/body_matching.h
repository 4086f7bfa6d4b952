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
  bool entangled = false;  ///< too large a degree to match parts by the article's rules
  int head = -1;           ///< -1: none
  std::vector<int> hands;  ///< nearest in depth first where there was a choice
};

/// For each object the person it belongs to, or -1. Only heads that lie mostly in a person box, in
/// its upper part where it is upright, with their top border within a head's height of the box's
/// top, can belong to a person; the pairs with the least distance between these borders come first,
/// and a person has one head. Beyond the article: with overlapping persons a head usually meets
/// several boxes.
std::vector<int> owners_of_heads(std::span<const SceneObject> objects,
                                 const BodyMatchingOptions& options);

/// The head of a person among `heads` (object indices). None or one: that one. Of more: in the
/// upper part of a box that is taller than wide, at about the person's depth, with the top border
/// nearest to the person's. -1 when none is left.
int match_head(std::span<const SceneObject> objects, int person, std::vector<int> heads,
               const BodyMatchingOptions& options);

/// The hands of a person among `hands` (object indices). Up to two: those. Of more: those at about
/// the depth of the matched head (without one, of the person), the two nearest to it; no reference
/// depth at all: none.
std::vector<int> match_hands(std::span<const SceneObject> objects, int person, int head,
                             std::vector<int> hands, const BodyMatchingOptions& options);

/// One body for each person, in the order of the objects (article, section 3.3.2). Candidates are
/// the heads and hands whose boxes meet the person's. A coincidence degree above the limit:
/// entangled, nothing matched; above 0: the head only; 0: head and hands.
///
/// With `own_heads` a head that belongs to one of two overlapping persons is no candidate of the
/// other, and an entangled person keeps the head that belongs to it.
std::vector<Body> match_bodies(std::span<const SceneObject> objects,
                               const BodyMatchingOptions& options, bool own_heads);

/// The measured depths of a body's parts.
BodyDepths depths_of(const Body& body, std::span<const SceneObject> objects);

}  // namespace ydd
