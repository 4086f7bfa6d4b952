// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "ydd/features/features.h"

namespace ydd {

/// Which rule decided about a feature point (section numbers of docs/method.md).
enum class Rule : std::uint8_t {
  kept,               ///< static: no rule rejected it
  box,                ///< variant `box`: inside a person box
  body_depth,         ///< 5: inside a person box and its depth range
  automatic_depth,    ///< 5: inside an automatic object and its depth range
  moved_by_hand,      ///< 6: on an object that a hand moves
  moved_near_body,    ///< 6: on an object within the body's depth range, hands hidden
  edge,               ///< 7: within 3 px of a moving silhouette
  around_hand,        ///< 7: near a hand and at its depth
  full_depth_failed,  ///< 8.1: the object's depth failed
  full_small_box,     ///< 8.2: the box is too small
  full_entangled,     ///< 8.3: overlaps another person by more than half
  seen_moving,        ///< variant `evidence`: on a surface that was seen to move
  surrounded,         ///< beyond the article: no depth, but all round it a moving thing
  lone_part,          ///< beyond the article: on a head or hand that belongs to no person
  connected,          ///< beyond the article: on what sticks out of a body's box
  bridged,            ///< beyond the article: on a person that was missed in this frame
};
inline constexpr int kRuleCount = 16;   ///< how many values Rule has
std::string_view to_string(Rule rule);  ///< The rule's name in files and on pictures: "body_depth".

/// A feature point that no later stage sees, kept for pictures and counters.
struct RejectedPoint {
  Keypoint keypoint;      ///< where it is in the image, without its descriptor
  float depth_m = 0;      ///< 0: no reading
  Rule rule = Rule::box;  ///< by which it went; never `kept`
};

/// The feature points of a frame, parted. The tracker and the map are given what is kept and
/// nothing else, so that nothing downstream can use a rejected point by mistake.
struct FilteredFeatures {
  std::shared_ptr<const Features> kept = std::make_shared<const Features>();  ///< judged static
  std::vector<RejectedPoint> rejected;  ///< judged to lie on something that moves

  /// How many points the extractor found: kept and rejected.
  std::size_t extracted() const { return kept->size() + rejected.size(); }
};

/// Number of rejected points per rule.
std::array<int, kRuleCount> count_rules(const FilteredFeatures& filtered);

}  // namespace ydd
