// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/dynamics/body_matching.h"
#include "ydd/dynamics/depth_range.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/dynamics/object_depth.h"

namespace ydd {

/// The readings along the pushed sides of the contact box, the intersection of a hand box with an
/// object box: each of its sides that lies inside the object box is pushed outward by `push_px` (by
/// `short_push_px` where less remains before the object's border) and read pixel by pixel. Only
/// valid readings. Empty when the boxes do not meet or the hand box covers the object.
std::vector<float> pushed_side_readings(const DepthImage& depth_m, const Box& hand,
                                        const Box& object, const MovedObjectOptions& options);

/// Whether a hand moves an object: enough readings along the pushed sides lie in the hand's depth
/// range, and the hand's depth lies in the object's (article, section 3.4.3). A hand box that
/// covers the whole object leaves no side to read: then the second condition decides alone. False
/// when either depth has failed.
bool moved_by_hand(const DepthImage& depth_m, const SceneObject& hand, const SceneObject& object,
                   double front_allowance, const MovedObjectOptions& options);

/// Whether an object may go with a body unseen by its hands: fewer than `hands` hands with a depth
/// were matched, and the boxes meet.
bool may_move_with(std::span<const SceneObject> objects, const Body& body,
                   const SceneObject& object, int hands);

/// Whether it does: its depth lies within the body's range besides. False when it has failed.
bool moved_near_body(std::span<const SceneObject> objects, const Body& body,
                     const DepthRange& body_range, const SceneObject& object, int hands);

}  // namespace ydd
