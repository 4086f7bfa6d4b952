// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/place_recall.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(PlaceCounts, RecallAtFullPrecisionAsksForMoreThanTheBestWrongAnswer) {
  PlaceCounts counts;
  counts.queries = 4;
  counts.right = {0.9, 0.5, 0.3};
  EXPECT_DOUBLE_EQ(counts.top1_recall(), 0.75);
  EXPECT_DOUBLE_EQ(counts.recall_at_full_precision(), 0.75);
  counts.wrong = {0.2, 0.5};
  EXPECT_DOUBLE_EQ(counts.recall_at_full_precision(), 0.25);
}

TEST(PlaceCounts, WithoutRevisitsNothingIsRecalled) {
  EXPECT_DOUBLE_EQ(PlaceCounts().top1_recall(), 0.0);
}

}  // namespace
}  // namespace ydd
