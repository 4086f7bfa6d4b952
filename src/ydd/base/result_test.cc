// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/result.h"

#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ydd {
namespace {

Result<int> half_of(int number) {
  if (number % 2 != 0) return Error{"numbers:3: 7 is odd; give an even number"};
  return number / 2;
}

Result<void> accept_positive(int number) {
  if (number <= 0) return Error{"not positive"};
  return {};
}

TEST(Result, HoldsAValue) {
  const Result<int> result = half_of(8);
  EXPECT_TRUE(result.ok());
  EXPECT_TRUE(static_cast<bool>(result));
  EXPECT_EQ(result.value(), 4);
  EXPECT_EQ(*result, 4);
}

TEST(Result, HoldsAnError) {
  const Result<int> result = half_of(7);
  EXPECT_FALSE(result.ok());
  EXPECT_EQ(result.error().message, "numbers:3: 7 is odd; give an even number");
}

TEST(Result, ThrowsWithTheMessageWhenThereIsNoValue) {
  const Result<int> result = half_of(7);
  try {
    result.value();
    FAIL() << "value() of an error must throw";
  } catch (const std::logic_error& e) {
    EXPECT_NE(std::string(e.what()).find("7 is odd"), std::string::npos);
  }
  EXPECT_THROW(*result, std::logic_error);
}

TEST(Result, ThrowsWhenAskedForTheErrorOfAValue) {
  EXPECT_THROW(half_of(8).error(), std::bad_variant_access);
}

TEST(Result, CanBeWrittenThrough) {
  Result<std::string> result = std::string("ab");
  result->push_back('c');
  *result += "d";
  EXPECT_EQ(result.value(), "abcd");
  EXPECT_EQ(result->size(), 4U);
}

TEST(Result, MovesItsValueOut) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(5);
  const std::unique_ptr<int> taken = *std::move(result);
  EXPECT_EQ(*taken, 5);
  EXPECT_EQ(*Result<std::unique_ptr<int>>(std::make_unique<int>(6)).value(), 6);
}

TEST(Result, OfNothingIsGoodOrAnError) {
  EXPECT_TRUE(accept_positive(1).ok());
  EXPECT_TRUE(Result<void>());
  const Result<void> refused = accept_positive(0);
  EXPECT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "not positive");
}

}  // namespace
}  // namespace ydd
