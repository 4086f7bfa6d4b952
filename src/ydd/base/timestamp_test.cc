// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/timestamp.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(Timestamp, KeepsEveryDigit) {
  const auto stamp = parse_timestamp("1305031102.175304");
  ASSERT_TRUE(stamp);
  EXPECT_EQ(stamp->ns, 1'305'031'102'175'304'000);
  EXPECT_EQ(format_timestamp(*stamp), "1305031102.175304000");
}

TEST(Timestamp, ReadsTheFormsOfANumber) {
  const std::pair<const char*, std::int64_t> cases[] = {
      {"12", 12'000'000'000},
      {"0", 0},
      {"12.", 12'000'000'000},
      {".5", 500'000'000},
      {"-1.25", -1'250'000'000},
      {"-0.000000001", -1},
      {"0.000000001", 1},
      {"0.0000000019", 1},
      {"1.3e9", 1'300'000'000'000'000'000},
      {"2.5E-3", 2'500'000},
  };
  for (const auto& [text, ns] : cases) {
    const auto stamp = parse_timestamp(text);
    ASSERT_TRUE(stamp) << text;
    EXPECT_EQ(stamp->ns, ns) << text;
  }
}

TEST(Timestamp, RefusesWhatIsNoNumber) {
  for (const char* text : {"",
                           ".",
                           "-",
                           "-.",
                           "--1",
                           "1.2.3",
                           "1,5",
                           "abc",
                           "1x",
                           "0x10",
                           " 1",
                           "1 ",
                           "1.-5",
                           "nan",
                           "inf",
                           "1e400",
                           "1e99",
                           "e5",
                           "99999999999999999999",
                           "9999999999999",
                           "+",
                           "1.+5"}) {
    EXPECT_FALSE(parse_timestamp(text)) << "'" << text << "'";
  }
}

TEST(Timestamp, FormatsAndParsesBack) {
  for (const std::int64_t ns :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1}, std::int64_t{999'999'999},
        std::int64_t{-1'500'000'000}, std::int64_t{1'700'000'000'123'456'789}}) {
    const auto again = parse_timestamp(format_timestamp(Timestamp{ns}));
    ASSERT_TRUE(again) << ns;
    EXPECT_EQ(again->ns, ns);
  }
}

TEST(Timestamp, ComparesAndSubtracts) {
  const Timestamp a{1'000'000'000};
  const Timestamp b{1'500'000'000};
  EXPECT_LT(a, b);
  EXPECT_DOUBLE_EQ(seconds_between(a, b), 0.5);
  EXPECT_DOUBLE_EQ(seconds_between(b, a), -0.5);
  EXPECT_DOUBLE_EQ(b.seconds(), 1.5);
}

}  // namespace
}  // namespace ydd
