// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/wire_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/messages/wire_testing.h"

namespace ydd {
namespace {

TEST(WireReader, ReadsBothWires) {
  for (const Wire wire : {Wire::ros1, Wire::cdr}) {
    WireWriter w(wire);
    w.u8(3).u32(70000).string("abc").u8(1).f64(-2.5).bytes("xyz").u32(2).f64(1).f64(2);
    WireReader r(w.text(), wire);
    EXPECT_EQ(r.u8(), 3);
    EXPECT_EQ(r.u32(), 70000U);
    EXPECT_EQ(r.text(), "abc");
    EXPECT_EQ(r.u8(), 1);
    EXPECT_EQ(r.f64(), -2.5);
    EXPECT_EQ(r.bytes(), "xyz");
    EXPECT_THAT(r.f64_sequence(2), testing::ElementsAre(1, 2));
    EXPECT_TRUE(r.ok());
    EXPECT_EQ(r.left(), 0U);
  }
}

TEST(WireReader, BytesOfCdrByHand) {
  // u8, padding, u32 in either byte order: what the specification shows.
  const std::string little(
      "\0\1\0\0"
      "\7\0\0\0"
      "\1\2\0\0",
      12);
  const std::string big(
      "\0\0\0\0"
      "\7\0\0\0"
      "\0\0\2\1",
      12);
  for (const std::string& text : {little, big}) {
    WireReader r(text, Wire::cdr);
    EXPECT_EQ(r.u8(), 7);
    EXPECT_EQ(r.u32(), 0x201U);
    EXPECT_TRUE(r.ok());
  }
}

TEST(WireReader, WhatIsNotThereIsZeroFromThenOn) {
  const std::string text("\1\0\0", 3);
  WireReader r(text, Wire::ros1);
  EXPECT_EQ(r.u32(), 0U);
  EXPECT_FALSE(r.ok());
  EXPECT_EQ(r.u8(), 0) << "although a byte is left";
  // A length that reaches beyond the end.
  WireReader longer(std::string_view("\xff\xff\xff\xff"
                                     "ab",
                                     6),
                    Wire::ros1);
  EXPECT_EQ(longer.text(), "");
  EXPECT_FALSE(longer.ok());
  WireReader many(std::string_view("\x03\0\0\0", 4), Wire::ros1);
  EXPECT_TRUE(many.f64_sequence(2).empty());
  EXPECT_FALSE(many.ok());
  // Neither of the two plain representations.
  EXPECT_FALSE(WireReader(std::string_view("\0\7\0\0", 4), Wire::cdr).ok());
  EXPECT_FALSE(WireReader("", Wire::cdr).ok());
}

}  // namespace
}  // namespace ydd
