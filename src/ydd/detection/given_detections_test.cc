// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/given_detections.h"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::HasSubstr;

constexpr int kWidth_px = 64;
constexpr int kHeight_px = 48;

Result<Detections> given(Detections detections) {
  return given_detections(std::move(detections), ObjectCatalogue::defaults(), kWidth_px, kHeight_px,
                          "mine");
}

GreyImage mask_of(const Box& box, int width_px = kWidth_px, int height_px = kHeight_px) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width_px) * height_px);
  for (auto y = static_cast<int>(box.y0); y < static_cast<int>(box.y1); ++y) {
    for (auto x = static_cast<int>(box.x0); x < static_cast<int>(box.x1); ++x) {
      pixels[static_cast<std::size_t>(y) * width_px + x] = 255;
    }
  }
  return {width_px, height_px, std::move(pixels)};
}

std::string error_of(const Result<Detections>& result) {
  return result ? "no error" : result.error().message;
}

TEST(GivenDetections, AreCutNamedAndSorted) {
  const auto found = given({{"chair", 0.4F, {60, 10, 80, 20}},
                            {"head", 0.5F, {1, 1, 9, 9}},
                            {"man", 0.9F, {2, 2, 8, 8}},
                            {"cup", 1.0F, {70, 2, 80, 8}}});
  ASSERT_TRUE(found) << error_of(found);
  ASSERT_EQ(found->size(), 3U);
  EXPECT_EQ(found->at(0).score, 0.9F);
  EXPECT_EQ(found->at(2).class_name, "chair");
  EXPECT_EQ(found->at(2).box, (Box{60, 10, 64, 20}));
}

TEST(GivenDetections, PeopleAreCalledAsTheRulesCallThem) {
  const auto table = ObjectCatalogue::parse("classes: {person: [pedestrian], hand: [paw]}", "t");
  ASSERT_TRUE(table);
  const auto found = given_detections(
      {{"pedestrian", 1, {0, 0, 9, 9}}, {"paw", 0.5F, {0, 0, 9, 9}}}, *table, 64, 48, "mine");
  ASSERT_TRUE(found) << error_of(found);
  EXPECT_EQ(found->at(0).class_name, "person");
  EXPECT_EQ(found->at(1).class_name, "hand");
}

TEST(GivenDetections, AMaskGivesItsBox) {
  const Box box{10, 12, 20, 31};
  const auto found = given({{"person", 1, {}, mask_of(box)}, {"person", 1, {}, mask_of({})}});
  ASSERT_TRUE(found) << error_of(found);
  ASSERT_EQ(found->size(), 1U);  // an empty mask shows nothing
  EXPECT_EQ(found->front().box, box);
}

TEST(GivenDetections, OneLineTellsWhichAndWhy) {
  const Detection good{"person", 1, {0, 0, 9, 9}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(error_of(given({good, {"", 1, {0, 0, 9, 9}}})),
              HasSubstr("mine: detection 1 ('') has no class"));
  EXPECT_THAT(error_of(given({{"cup", 1.5F, {0, 0, 9, 9}}})), HasSubstr("score 1.5"));
  EXPECT_THAT(error_of(given({{"cup", nan, {0, 0, 9, 9}}})), HasSubstr("score nan"));
  EXPECT_THAT(error_of(given({{"cup", 1, {9, 0, 0, 9}}})), HasSubstr("must be [x0, y0, x1, y1]"));
  EXPECT_THAT(error_of(given({{"cup", 1, {0, nan, 9, 9}}})), HasSubstr("must be"));
  EXPECT_THAT(error_of(given({{"cup", 1, {0, 0, 300, 9}}})), HasSubstr("far beyond the picture"));
  EXPECT_THAT(error_of(given({{"cup", 1, {0.1F, 0.2F, 0.9F, 0.8F}}})), HasSubstr("fractions"));
  EXPECT_THAT(error_of(given({{"cup", 1, {}, mask_of({}, 32, 48)}})),
              HasSubstr("a mask of 32 x 48, but the picture has 64 x 48"));
}

}  // namespace
}  // namespace ydd
