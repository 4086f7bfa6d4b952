// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/compensation.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace ydd {
namespace {

const CompensationOptions kCompensation;

TEST(NextBudget, OfAStaticFrameIsN) {
  EXPECT_EQ(next_budget(1000, 0, false, kCompensation), 1000);
  EXPECT_EQ(next_budget(1000, 700, false, kCompensation), 1000);
  EXPECT_EQ(next_budget(1000, 0, true, kCompensation), 1000);
  EXPECT_EQ(next_budget(0, 0, true, kCompensation), 1000);
}

TEST(NextBudget, MakesUpForWhatWasRejected) {
  EXPECT_EQ(next_budget(1000, 200, true, kCompensation), 1250);
  EXPECT_EQ(next_budget(2000, 1000, true, kCompensation), 2000);  // eta = 0.5: no boost yet
}

TEST(NextBudget, BoostsAboveHalf) {
  EXPECT_EQ(next_budget(1000, 600, true, kCompensation), 3000);
  EXPECT_EQ(next_budget(1000, 501, true, kCompensation), 2405);
}

TEST(NextBudget, NeverExceedsItsLimit) {
  EXPECT_EQ(next_budget(1000, 900, true, kCompensation), 3500);
  EXPECT_EQ(next_budget(1000, 1000, true, kCompensation), 3500);
}

TEST(NextBudget, ALimitBelowNTakesNothingAway) {
  CompensationOptions options;
  options.most_points = 800;
  EXPECT_EQ(next_budget(1000, 900, true, options), 1000);
}

TEST(NextBudget, RejectedPointsAreAmongTheExtracted) {
  EXPECT_THROW(next_budget(10, 11, true, kCompensation), std::logic_error);
  EXPECT_THROW(next_budget(10, -1, true, kCompensation), std::logic_error);
}

}  // namespace
}  // namespace ydd
