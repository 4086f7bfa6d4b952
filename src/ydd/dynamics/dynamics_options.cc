// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/dynamics_options.h"

#include <algorithm>

namespace ydd {
void ObjectDepthOptions::describe(OptionTable& table) {
  table.add("arm_samples", arm_samples, {1, 100}, "", "depth samples on each arm of the cross");
  table.add("arm_share", arm_share, {0.01, 0.5}, "",
            "length of an arm of the cross as share of the box side along it");
  table.add("nearest_samples", nearest_samples, {1, 100}, "",
            "nearest readings of an arm that are averaged");
  table.add("head_window_px", head_window_px, {0, 50}, "px",
            "half side of the window searched for a reading round a head's centre");
}

void BodyMatchingOptions::describe(OptionTable& table) {
  table.add("entangled_degree", entangled_degree, {0, 1}, "",
            "share of a person box covered by another above which it is not matched");
  table.add("head_upper_share", head_upper_share, {0, 1}, "",
            "upper part of an upright person box in which its head must lie");
  table.add("head_depth_m", head_depth_m, {0, 10}, "m",
            "largest difference between the depths of a head and its person");
  table.add("hand_depth_m", hand_depth_m, {0, 10}, "m",
            "largest difference between the depths of a hand and its head or person");
  table.add("hands", hands, {0, 10}, "", "hands of a person");
}

void MovedObjectOptions::describe(OptionTable& table) {
  table.add("push_px", push_px, {1, 50}, "px",
            "how far the sides of the contact of hand and object are pushed outward");
  table.add("short_push_px", short_push_px, {1, 50}, "px",
            "the same where less than push_px remain before the object's border");
  table.add("contact_readings", contact_readings, {1, 1000}, "",
            "readings at the hand's depth along the pushed sides that make a contact");
}

void CompensationOptions::describe(OptionTable& table) {
  table.add("points", points, {50, 20000}, "", "points asked of a static frame");
  table.add("boost", boost, {1, 10}, "", "factor when many points were rejected");
  table.add("boost_above", boost_above, {0, 1}, "",
            "share of rejected points above which the boost applies");
  table.add("most_points", most_points, {50, 100000}, "", "points never exceeded by compensation");
}

void ConnectedObjectOptions::describe(OptionTable& table) {
  table.add("cell_px", cell_px, {1, 32}, "px", "step at which the depth image is looked at");
  table.add("step_share", step_share, {0.001, 1}, "",
            "largest step in depth between neighbouring cells of one surface, share of the depth");
  table.add("reach_m", reach_m, {0, 5}, "m",
            "a surface that goes on further from the body's box is furniture");
  table.add("focal_share", focal_share, {0.1, 5}, "",
            "focal length as share of the image width, to turn reach_m into pixels");
  table.add("least_cells", least_cells, {1, 10000}, "", "cells of a surface that counts");
}

void BridgingOptions::describe(OptionTable& table) {
  table.add("frames", frames, {0, 100}, "frames", "how long a missed person is carried on");
  table.add("seen", seen, {1, 100}, "frames", "how often it must have been seen before");
  table.add("overlap", overlap, {0.01, 1}, "",
            "intersection over union that makes two boxes the same person");
}

void RefinementOptions::describe(OptionTable& table) {
  table.add("enabled", enabled, "what goes beyond the article; false: exactly the article's rules");
  table.add("uncovered_heads", uncovered_heads,
            "a head whose centre is behind a hand or a small object is measured beside it");
  table.add("own_heads", own_heads, "a head belongs to one person only when persons overlap");
  table.add("entangled_by_head", entangled_by_head,
            "an entangled person with a head of its own is judged by that head's depth");
  table.add("hidden_bodies", hidden_bodies,
            "an overlapping person without a head is judged by what the others leave of its box");
  table.add("rest_share", rest_share, {0, 1}, "",
            "share of the readings in the box that the others must leave");
  table.add("spare_unmeasured", spare_unmeasured,
            "an object without depth is rejected only where a hand meets it, not near a body");
  table.add("any_hand", any_hand, "objects are moved by hands of overlapping persons too");
  table.add("lone_parts", lone_parts, "a head or hand without a person is judged by itself");
  table.add("surrounded", surrounded,
            "a point without depth is rejected when the readings round it are on a moving thing");
  table.add("surround_px", surround_px, {1, 100}, "px", "how far these readings are looked for");
  table.add("surround_axes", surround_axes, {1, 4}, "",
            "of the four axes through the point, how many must end on the moving thing both ways");
  table.add("unmeasured_edge_px", unmeasured_edge_px, {0, 50}, "px",
            "edge_radius_px of points without a depth reading of their own");
  table.add("connected", connected, "what sticks out of a body's box moves with it");
  table.group("connected_things", connected_things);
  table.add("bridging", bridging, "persons missed for a few frames are carried on");
  table.group("bridge", bridge);
}

void DynamicsOptions::describe(OptionTable& table) {
  table.add("variant", variant,
            "what is rejected: nothing, person boxes, persons by depth, the whole method");
  table.add("static_after_frames", static_after_frames, {1, 1000}, "frames",
            "frames without a dynamic object after which a frame is static");
  table.add("front_allowance", front_allowance, {0, 1}, "",
            "share of an object's extent allowed in front of its measured depth");
  table.add("small_box_share", small_box_share, {0, 1}, "",
            "share of the image below which a person or automatic object is rejected as a whole");
  table.add("edge_radius_px", edge_radius_px, {0, 50}, "px",
            "distance of the four readings that tell a point at a moving silhouette");
  table.add("hand_scale", hand_scale, {1, 10}, "", "scale of a hand box for points around hands");
  table.group("object_depth", object_depth);
  table.group("matching", matching);
  table.group("moved", moved);
  table.group("compensation", compensation);
  table.group("refinement", refinement);
  table.group("evidence", evidence);
}

DynamicsOptions DynamicsOptions::resolved() const {
  DynamicsOptions result = *this;
  if (refinement.enabled) return result;
  RefinementOptions& r = result.refinement;
  for (bool* const option : {&r.uncovered_heads, &r.own_heads, &r.entangled_by_head,
                             &r.hidden_bodies, &r.spare_unmeasured, &r.any_hand, &r.lone_parts,
                             &r.surrounded, &r.connected, &r.bridging}) {
    *option = false;
  }
  return result;
}

}  // namespace ydd
