// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/pairing.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::HasSubstr;

constexpr double kTolerance_s = 0.02;

Timestamp after_s(double seconds) {
  return {1'000'000'000'000'000'000 + std::llround(1e9 * seconds)};
}

std::vector<Timestamp> every_33_ms(int count, double first_s = 0) {
  std::vector<Timestamp> out;
  for (int i = 0; i < count; ++i) out.push_back(after_s(first_s + i / 30.0));
  return out;
}

Pairing judged(const std::vector<Timestamp>& colour, const std::vector<Timestamp>& depth) {
  return judge_pairing(colour, depth, associate(colour, depth, kTolerance_s), kTolerance_s);
}

TEST(Pairing, NothingIsSaidOfTwoCamerasThatRunFreely) {
  const Pairing pairing = judged(every_33_ms(100), every_33_ms(99, 0.006));
  EXPECT_EQ(pairing.pairs, 99U);
  EXPECT_NEAR(pairing.depth_later_s, 0.006, 1e-6);
  EXPECT_EQ(pairing_warning(pairing, kTolerance_s), "");
}

TEST(Pairing, AClockThatJumpsIsToldWithTheOffsetThatFits) {
  std::vector<Timestamp> depth = every_33_ms(100);
  for (std::size_t i = 1; i < depth.size(); ++i) depth[i].ns += 3'600'000'000'000;
  const Pairing pairing = judged(every_33_ms(100), depth);
  EXPECT_EQ(pairing.pairs, 1U);
  EXPECT_EQ(pairing.fitting_pairs, 99U);
  EXPECT_NEAR(pairing.fitting_offset_s, -3600, 0.01);
  EXPECT_THAT(pairing_warning(pairing, kTolerance_s),
              HasSubstr("only 1 of 100 colour images have a depth image within 0.02 s"));
  EXPECT_THAT(pairing_warning(pairing, kTolerance_s), HasSubstr("--depth-offset=-36"));
}

TEST(Pairing, DepthThatIsSteadilyLateIsTold) {
  const Pairing pairing = judged(every_33_ms(100), every_33_ms(100, 0.012));
  EXPECT_GE(pairing.pairs, 99U);
  EXPECT_TRUE(pairing.steadily_late);
  EXPECT_THAT(pairing_warning(pairing, kTolerance_s), HasSubstr("--depth-offset auto"));
}

TEST(Pairing, ASlowerDepthCameraIsNoFault) {
  std::vector<Timestamp> depth;
  for (int i = 0; i < 50; ++i) depth.push_back(after_s(i / 15.0));
  EXPECT_EQ(pairing_warning(judged(every_33_ms(100), depth), kTolerance_s), "");
}

}  // namespace
}  // namespace ydd
