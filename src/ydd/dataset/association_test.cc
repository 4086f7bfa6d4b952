// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/association.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<Timestamp> stamps_ms(const std::vector<int>& times_ms) {
  std::vector<Timestamp> stamps;
  for (const int t : times_ms) stamps.push_back({t * std::int64_t{1'000'000}});
  return stamps;
}

TEST(Associate, ClosestPairWinsAndLosersTakeWhatIsLeft) {
  // 10 is nearer to 11 than 14 is; 14 then gets 20, although 11 would have been nearer.
  EXPECT_THAT(associate(stamps_ms({10, 14}), stamps_ms({11, 20}), 0.02),
              ElementsAre(IndexPair{0, 0}, IndexPair{1, 1}));
}

TEST(Associate, IsOneToOneInTheOrderOfTheFirst) {
  EXPECT_THAT(associate(stamps_ms({0, 30, 60, 90}), stamps_ms({31, 92}), 0.02),
              ElementsAre(IndexPair{1, 0}, IndexPair{3, 1}));
  EXPECT_THAT(associate(stamps_ms({30}), stamps_ms({25, 28, 31, 40}), 0.02),
              ElementsAre(IndexPair{0, 2}));
}

TEST(Associate, ToleranceIsExclusive) {
  EXPECT_THAT(associate(stamps_ms({0}), stamps_ms({20}), 0.02), IsEmpty());
  EXPECT_THAT(associate(stamps_ms({20}), stamps_ms({0}), 0.02), IsEmpty());
  EXPECT_THAT(associate(stamps_ms({0}), stamps_ms({19}), 0.02), ElementsAre(IndexPair{0, 0}));
}

TEST(Associate, TiesGoToTheEarlier) {
  EXPECT_THAT(associate(stamps_ms({10}), stamps_ms({5, 15}), 0.02), ElementsAre(IndexPair{0, 0}));
  EXPECT_THAT(associate(stamps_ms({5, 15}), stamps_ms({10}), 0.02), ElementsAre(IndexPair{0, 0}));
}

TEST(Associate, RefusesUnsortedStamps) {
  EXPECT_THROW(associate(stamps_ms({5, 5}), stamps_ms({10}), 0.02), std::logic_error);
  EXPECT_THROW(associate(stamps_ms({5}), stamps_ms({10, 9}), 0.02), std::logic_error);
}

TEST(NearestIndex, InsideAndBeyondTheEnds) {
  const auto stamps = stamps_ms({10, 20, 40});
  const auto nearest = [&](int t) { return nearest_index(stamps, stamps_ms({t}).front()); };
  EXPECT_EQ(nearest(-5), 0U);
  EXPECT_EQ(nearest(10), 0U);
  EXPECT_EQ(nearest(15), 0U);
  EXPECT_EQ(nearest(16), 1U);
  EXPECT_EQ(nearest(31), 2U);
  EXPECT_EQ(nearest(99), 2U);
}

}  // namespace
}  // namespace ydd
