// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ydd/base/options.h"
#include "ydd/evidence/evidence_options.h"

namespace ydd {

/// What is rejected (docs/method.md, section 9).
enum class Variant { off, box, person, full, evidence };
constexpr std::array<std::string_view, 5> choices_of(Variant) {
  return {"off", "box", "person", "full", "evidence"};
}
/// Whether the variant rejects nothing unless something is detected.
constexpr bool needs_boxes(Variant variant) {
  return variant != Variant::off && variant != Variant::evidence;
}
/// What a run without boxes makes of the variant that it was asked for.
constexpr Variant without_boxes(Variant asked) { return needs_boxes(asked) ? Variant::off : asked; }

/// Section 3: where an object's depth is sampled.
struct ObjectDepthOptions {
  int arm_samples = 8;      ///< per arm of the cross
  double arm_share = 0.4;   ///< length of an arm as share of the box side along it
  int nearest_samples = 3;  ///< averaged, the nearest ones of the nearer arm
  int head_window_px = 7;   ///< half side of the window searched round a head's centre
  void describe(OptionTable& table);
};

/// Section 4: which head and hands belong to which person.
struct BodyMatchingOptions {
  double entangled_degree = 0.5;  ///< coincidence degree above which a person is not matched
  double head_upper_share = 0.5;  ///< upper part of an upright person box that may hold the head
  double head_depth_m = 0.5;      ///< largest difference between head and person depth
  double hand_depth_m = 0.7;      ///< largest difference between hand and head (or person) depth
  int hands = 2;                  ///< per person
  void describe(OptionTable& table);
};

/// Section 6: is a potentially dynamic object being moved?
struct MovedObjectOptions {
  int push_px = 3;           ///< how far the sides of the contact box are pushed outward
  int short_push_px = 1;     ///< the same where less than push_px remain
  int contact_readings = 3;  ///< readings at the hand's depth that make a contact
  void describe(OptionTable& table);
};

/// Section 7, compensation: how many points the next frame asks for.
struct CompensationOptions {
  int points = 1000;         ///< N, of a static frame
  double boost = 1.2;        ///< alpha
  double boost_above = 0.5;  ///< share of rejected points above which the boost applies
  int most_points = 3500;    ///< epsilon
  void describe(OptionTable& table);
};

/// Beyond the article: what sticks out of the box of a body.
struct ConnectedObjectOptions {
  int cell_px = 4;            ///< step at which the depth image is looked at
  double step_share = 0.03;   ///< of the depth: largest step between cells of one surface
  double reach_m = 0.4;       ///< a surface that goes on further from the box is furniture
  double focal_share = 0.85;  ///< focal length as share of the image width; need not be exact
  int least_cells = 4;        ///< of a surface that counts
  void describe(OptionTable& table);
};

/// Beyond the article: persons that the detector misses for a few frames.
struct BridgingOptions {
  int frames = 10;       ///< carried on for at most so many
  int seen = 3;          ///< only what was seen in so many
  double overlap = 0.3;  ///< intersection over union that makes two boxes the same person
  void describe(OptionTable& table);
};

/// What goes beyond the article; each can be switched off by itself (docs/method.md, section 10).
struct RefinementOptions {
  bool enabled = true;            ///< false: exactly the article's rules
  bool uncovered_heads = true;    ///< a head behind a hand is measured beside the hand
  bool own_heads = true;          ///< a head belongs to one person only when persons overlap
  bool entangled_by_head = true;  ///< an entangled person with a head of its own keeps its range
  bool hidden_bodies = true;      ///< one without a head is judged by what the others leave of it
  double rest_share = 0.05;       ///< of the readings in its box that must be left
  bool spare_unmeasured = true;   ///< an object without depth goes only where a hand meets it
  bool any_hand = true;           ///< objects are moved by hands of overlapping persons too
  bool lone_parts = true;         ///< a head or hand without a person is judged by itself
  bool surrounded = true;         ///< a point without depth goes when the readings round it go
  int surround_px = 24;           ///< how far these readings are looked for
  int surround_axes = 3;          ///< of four axes through the point, that end on it both ways
  double unmeasured_edge_px = 3;  ///< the edge radius for points without a reading of their own
  bool connected = true;          ///< what sticks out of a body's box moves with it
  ConnectedObjectOptions connected_things;
  bool bridging = true;  ///< persons missed for a few frames are carried on
  BridgingOptions bridge;
  void describe(OptionTable& table);
};

/// All of the method's thresholds. Depth extents live in the object catalogue.
struct DynamicsOptions {
  Variant variant = Variant::evidence;
  int static_after_frames = 5;    ///< without a dynamic object: from then on a frame is static
  double front_allowance = 0.2;   ///< share of the extent in front of the approximate minimum depth
  double small_box_share = 0.01;  ///< of the image: below it every point of a box goes
  double edge_radius_px = 3;      ///< of the circle that FAST looks at
  double hand_scale = 2;          ///< of the hand box for points around hands
  ObjectDepthOptions object_depth;
  BodyMatchingOptions matching;
  MovedObjectOptions moved;
  CompensationOptions compensation;
  RefinementOptions refinement;
  EvidenceOptions evidence;

  /// Whether all rules are meant, with evidence or without.
  bool whole() const { return variant == Variant::full || variant == Variant::evidence; }
  void describe(OptionTable& table);
  /// What is meant: unless `refinement.enabled`, every refinement is off. Functions below the judge
  /// ask for nothing but their own switch.
  DynamicsOptions resolved() const;
};

}  // namespace ydd
