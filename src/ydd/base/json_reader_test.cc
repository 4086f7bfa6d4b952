// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ydd {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& text) {
  const auto json = parse_json(text, "a.json");
  return json ? "no error" : json.error().message;
}

std::string nested(int levels) {
  return std::string(static_cast<std::size_t>(levels), '[') +
         std::string(static_cast<std::size_t>(levels), ']');
}

TEST(JsonReader, ReadsInTheOrderOfTheText) {
  const auto json = parse_json(R"({"z": [1, {"\"[": "}"}], "a": "\\"})", "a.json");
  ASSERT_TRUE(json) << json.error().message;
  EXPECT_EQ(json->dump(), R"({"z":[1,{"\"[":"}"}],"a":"\\"})");
}

TEST(JsonReader, NestingHasABound) {
  EXPECT_EQ(error_of(nested(64)), "no error");
  EXPECT_EQ(error_of(nested(65)), "a.json: JSON nested in more than 64 levels");
  EXPECT_THAT(error_of(nested(5'000'000)), HasSubstr("nested"));
  EXPECT_THAT(error_of(std::string(5'000'000, '[')), HasSubstr("nested"));
  // Brackets in text, and many side by side, are no nesting.
  EXPECT_EQ(error_of("[\"" + std::string(1000, '[') + "\", \"\\\"" + std::string(99, '{') + "\"]"),
            "no error");
  std::string wide = "[0";
  for (int i = 0; i < 1000; ++i) wide += ",[{}]";
  EXPECT_EQ(error_of(wide + "]"), "no error");
}

TEST(JsonReader, WhatIsNoJsonIsOneLine) {
  EXPECT_EQ(error_of("{\"a\": 1,}"), "a.json: not valid JSON at character 9");
  EXPECT_EQ(error_of("[1e999]"), "a.json: a number in it is out of range");
  for (const char* const text : {"", "nul", "[1", "\"a", "\"\xff\"", "[] []", "{\"a\" 1}", "NaN"}) {
    EXPECT_THAT(error_of(text), HasSubstr("a.json: not valid JSON")) << text;
  }
}

}  // namespace
}  // namespace ydd
