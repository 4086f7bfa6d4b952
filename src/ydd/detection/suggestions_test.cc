// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/suggestions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ydd {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

Detection scored(const std::string& name, float score) { return {name, score, {1, 2, 30.04F, 40}}; }

TEST(Suggestions, DoubtIsLargestAtEvenOdds) {
  EXPECT_EQ(doubt({}), 0);
  EXPECT_NEAR(doubt({scored("hand", 0.5F)}), 1.0, 1e-6);
  EXPECT_NEAR(doubt({scored("hand", 0.9F), scored("cup", 0.5F)}), 1.36, 1e-6);
  EXPECT_LT(doubt({scored("hand", 0.95F)}), doubt({scored("hand", 0.6F)}));
}

TEST(Suggestions, TheMostDoubtfulStayApart) {
  const std::vector<double> doubts{0.1, 3, 2.9, 0, 2, 2.1, 0};
  EXPECT_THAT(most_doubtful(doubts, 2, 2), ElementsAre(1, 5));
  EXPECT_THAT(most_doubtful(doubts, 2, 1), ElementsAre(1, 2));
  EXPECT_THAT(most_doubtful(doubts, 100, 1), ElementsAre(0, 1, 2, 4, 5));
  EXPECT_THAT(most_doubtful({}, 3, 1), IsEmpty());
}

TEST(Suggestions, WeakBoxesAreUnknownInTheLabels) {
  const json labels = json::parse(training_labels({scored("hand", 0.8F), scored("cup", 0.2F)}));
  EXPECT_EQ(labels, json::parse(R"({"boxes": [["hand", 1, 2, 30, 40]],
                                    "ignore": [["cup", 1, 2, 30, 40]]})"));
}

}  // namespace
}  // namespace ydd
