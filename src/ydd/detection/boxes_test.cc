// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/boxes.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(Boxes, OverlapMeasures) {
  const Box a{0, 0, 10, 10};
  EXPECT_FLOAT_EQ(intersection_over_union(a, a), 1.0F);
  EXPECT_FLOAT_EQ(intersection_over_union(a, {5, 0, 15, 10}), 1.0F / 3.0F);
  EXPECT_EQ(intersection_over_union(a, {10, 0, 20, 10}), 0.0F);
  EXPECT_EQ(intersection_over_union(a, {20, 20, 30, 30}), 0.0F) << "both sides negative";
  EXPECT_EQ(intersection_over_union({}, {}), 0.0F);
  EXPECT_FLOAT_EQ(coverage({5, 0, 15, 10}, a), 0.5F);
  EXPECT_FLOAT_EQ(coverage(a, {0, 0, 100, 100}), 1.0F);
  EXPECT_FLOAT_EQ(coverage({0, 0, 100, 100}, a), 0.01F);
  EXPECT_EQ(coverage({}, a), 0.0F);
}

TEST(Boxes, SuppressionIsClassWiseAndKeepsTheBest) {
  const Detections kept = suppress_non_maxima({{"person", 0.5F, {0, 0, 10, 10}},
                                               {"person", 0.9F, {1, 0, 11, 10}},
                                               {"chair", 0.4F, {0, 0, 10, 10}},
                                               {"person", 0.3F, {8, 0, 18, 10}}},
                                              0.45F);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].score, 0.9F);
  EXPECT_EQ(kept[1].class_name, "chair");
  EXPECT_EQ(kept[2].score, 0.3F) << "overlaps by less than the threshold";
}

TEST(Boxes, ASuppressedBoxSuppressesNobody) {
  // b overlaps a, c overlaps b but not a: b goes, c stays.
  const Detections kept = suppress_non_maxima(
      {{"p", 0.9F, {0, 0, 10, 10}}, {"p", 0.8F, {4, 0, 14, 10}}, {"p", 0.7F, {8, 0, 18, 10}}},
      0.3F);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[1].score, 0.7F);
}

TEST(Boxes, EqualScoresKeepTheirOrder) {
  const Detections sorted =
      sorted_by_score({{"a", 0.5F, {}}, {"b", 0.7F, {}}, {"c", 0.5F, {}}, {"d", 0.5F, {}}});
  EXPECT_EQ(sorted[0].class_name, "b");
  EXPECT_EQ(sorted[1].class_name, "a");
  EXPECT_EQ(sorted[2].class_name, "c");
  EXPECT_EQ(sorted[3].class_name, "d");
}

TEST(Boxes, ClippingDropsWhatIsOutside) {
  const Detections inside = clipped({{"a", 1, {-10, -10, 5, 5}},
                                     {"b", 1, {90, 40, 120, 60}},
                                     {"c", 1, {99.5F, 0, 120, 60}},
                                     {"d", 1, {200, 0, 220, 60}}},
                                    100, 50);
  ASSERT_EQ(inside.size(), 2U);
  EXPECT_EQ(inside[0].box, (Box{0, 0, 5, 5}));
  EXPECT_EQ(inside[1].box, (Box{90, 40, 100, 50}));
}

}  // namespace
}  // namespace ydd
