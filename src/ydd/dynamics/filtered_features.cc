// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/filtered_features.h"

namespace ydd {

std::string_view to_string(Rule rule) {
  static constexpr std::array<std::string_view, kRuleCount> kNames = {"kept",
                                                                      "box",
                                                                      "body_depth",
                                                                      "automatic_depth",
                                                                      "moved_by_hand",
                                                                      "moved_near_body",
                                                                      "edge",
                                                                      "around_hand",
                                                                      "full_depth_failed",
                                                                      "full_small_box",
                                                                      "full_entangled",
                                                                      "seen_moving",
                                                                      "surrounded",
                                                                      "lone_part",
                                                                      "connected",
                                                                      "bridged"};
  return kNames[static_cast<std::size_t>(rule)];
}

std::array<int, kRuleCount> count_rules(const FilteredFeatures& filtered) {
  std::array<int, kRuleCount> counts{};
  counts[0] = static_cast<int>(filtered.kept->size());
  for (const RejectedPoint& point : filtered.rejected) {
    ++counts[static_cast<std::size_t>(point.rule)];
  }
  return counts;
}

}  // namespace ydd
