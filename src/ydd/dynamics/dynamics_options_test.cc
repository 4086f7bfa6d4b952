// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/dynamics_options.h"

#include <set>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(DynamicsOptions, EveryThresholdIsAnOptionWithASentence) {
  DynamicsOptions options;
  OptionTable table;
  options.describe(table);
  std::set<std::string> keys;
  for (const Option& option : table.options()) {
    EXPECT_TRUE(keys.insert(option.key).second) << option.key;
    EXPECT_FALSE(option.sentence.empty()) << option.key;
    if (std::holds_alternative<int*>(option.target) ||
        std::holds_alternative<double*>(option.target)) {
      EXPECT_TRUE(std::isfinite(option.range.min) && std::isfinite(option.range.max)) << option.key;
    }
    // A default must be one that a file may say.
    EXPECT_TRUE(table.set(option.key, format_value(option), "test").ok()) << option.key;
  }
  for (const char* key : {"variant", "static_after_frames", "front_allowance", "small_box_share",
                          "edge_radius_px", "hand_scale", "matching.entangled_degree",
                          "moved.push_px", "compensation.most_points", "refinement.enabled"}) {
    EXPECT_TRUE(keys.contains(key)) << key;
  }
}

TEST(DynamicsOptions, DefaultsOfTheMethod) {
  const DynamicsOptions options;
  EXPECT_EQ(options.variant, Variant::evidence);
  EXPECT_EQ(options.static_after_frames, 5);
  EXPECT_EQ(options.front_allowance, 0.2);
  EXPECT_EQ(options.edge_radius_px, 3);
  EXPECT_EQ(options.hand_scale, 2);
  EXPECT_EQ(options.matching.entangled_degree, 0.5);
  EXPECT_EQ(options.matching.hands, 2);
  EXPECT_EQ(options.moved.push_px, 3);
  EXPECT_EQ(options.moved.short_push_px, 1);
  EXPECT_EQ(options.moved.contact_readings, 3);
  EXPECT_EQ(options.compensation.points, 1000);
  EXPECT_EQ(options.compensation.boost, 1.2);
  EXPECT_EQ(options.compensation.boost_above, 0.5);
  EXPECT_EQ(options.compensation.most_points, 3500);
}

TEST(DynamicsOptions, AnUnknownVariantIsRefused) {
  DynamicsOptions options;
  OptionTable table;
  options.describe(table);
  const auto result = table.set("variant", "some", "x.yaml:3");
  ASSERT_FALSE(result.ok());
  EXPECT_THAT(result.error().message, testing::HasSubstr("off, box, person, full"));
  EXPECT_EQ(options.variant, Variant::evidence);
}

TEST(RefinementOptions, OneSwitchTurnsAllOfThemOff) {
  DynamicsOptions options;
  EXPECT_TRUE(options.resolved().refinement.surrounded);
  options.refinement.enabled = false;
  const RefinementOptions off = options.resolved().refinement;
  EXPECT_FALSE(off.uncovered_heads || off.own_heads || off.entangled_by_head || off.hidden_bodies ||
               off.any_hand || off.lone_parts || off.surrounded || off.connected || off.bridging);
}

}  // namespace
}  // namespace ydd
