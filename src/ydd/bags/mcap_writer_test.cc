// SPDX-License-Identifier: Apache-2.0
#include "ydd/bags/mcap_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/bags/bag.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/messages/ros_writing.h"
#include "ydd/messages/wire_testing.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

const McapChannel kPictures{"/image", "sensor_msgs/msg/Image", "ros2msg",
                            std::string(ros2_definition("sensor_msgs/msg/Image")), "cdr"};

/// Pictures of `size` bytes, a millisecond apart.
std::string picture(int number, std::size_t size) {
  return image_message(Wire::cdr, {number * 1'000'000}, static_cast<std::uint32_t>(size), 1,
                       "mono8", static_cast<std::uint32_t>(size),
                       std::string(size, static_cast<char>(number)));
}

McapWriter written(const fs::path& file, int pictures, std::size_t size) {
  McapWriter writer = McapWriter::open(file, "ros2").value();
  EXPECT_TRUE(writer.add_metadata("a.note", {{"key", "value"}, {"other", ""}}));
  const std::uint16_t channel = writer.add_channel(kPictures);
  const std::uint16_t other = writer.add_channel({"/empty", "a/B", "jsonschema", "{}", "json"});
  EXPECT_NE(channel, other);
  for (int i = 0; i < pictures; ++i) {
    EXPECT_TRUE(writer.write(channel, {i * 1'000'000}, picture(i, size)));
  }
  return writer;
}

TEST(McapWriter, WritesWhatTheReaderReads) {
  constexpr std::size_t kSize = 1'000'000;  // four in a chunk
  const TemporaryFolder folder;
  McapWriter writer = written(folder / "a.mcap", 10, kSize);
  EXPECT_FALSE(fs::exists(folder / "a.mcap")) << "it appears when it is complete";
  EXPECT_TRUE(fs::exists(writer.hidden_name()));
  ASSERT_TRUE(writer.finish());
  const auto bag = open_bag(folder / "a.mcap").value();
  EXPECT_EQ(bag->incomplete(), "");
  ASSERT_THAT(bag->topics(), SizeIs(2));
  EXPECT_EQ(bag->topics()[0].name, "/image");
  EXPECT_EQ(bag->topics()[0].type, "sensor_msgs/msg/Image");
  ASSERT_THAT(bag->messages(), SizeIs(10));
  for (int i = 0; i < 10; ++i) {
    const BagMessage& message = bag->messages()[static_cast<std::size_t>(i)];
    EXPECT_EQ(message.stamp.ns, i * 1'000'000);
    EXPECT_EQ(message.received, message.stamp);
    EXPECT_EQ(bag->read(message).value(), picture(i, kSize));
  }
  EXPECT_EQ(bag->notes().at("a.note").at("key"), "value");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

std::uint64_t number(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) {
    value = value << 8U | static_cast<unsigned char>(bytes.at(at + i));
  }
  return value;
}

TEST(McapWriter, ItsSummaryLeadsToTheChunks) {
  const TemporaryFolder folder;
  ASSERT_TRUE(written(folder / "a.mcap", 10, 1'000'000).finish());
  const std::string bytes = read_file(folder / "a.mcap").value();
  ASSERT_TRUE(bytes.ends_with("\x89MCAP0\r\n"));
  // Footer: a byte, a length, where the summary starts, ...
  const std::size_t footer = bytes.size() - 8 - 9 - 20;
  ASSERT_EQ(bytes[footer], 2);
  std::size_t at = number(bytes, footer + 9, 8);
  int chunks = 0, channels = 0;
  std::uint64_t messages = 0;
  while (at < footer) {
    const int op = bytes[at];
    const std::size_t body = at + 9;
    if (op == 4) ++channels;
    if (op == 11) messages = number(bytes, body, 8);
    if (op == 8) {
      ++chunks;
      const std::size_t chunk = number(bytes, body + 16, 8);
      EXPECT_EQ(bytes.at(chunk), 6);
      EXPECT_EQ(number(bytes, chunk + 1, 8) + 9, number(bytes, body + 24, 8));
      // The one index: of the pictures, behind the chunk.
      ASSERT_EQ(number(bytes, body + 32, 4), 10U);
      const std::size_t index = number(bytes, body + 38, 8);
      EXPECT_EQ(bytes.at(index), 7);
      EXPECT_EQ(number(bytes, index + 9, 2), number(bytes, body + 36, 2));
      EXPECT_EQ(number(bytes, index + 11, 4) % 16, 0U);
    }
    if (op == 13) {
      EXPECT_EQ(bytes.at(number(bytes, body, 8)), 12);
    }
    at = body + number(bytes, at + 1, 8);
  }
  EXPECT_EQ(at, footer);
  EXPECT_EQ(chunks, 2);
  EXPECT_EQ(channels, 2);
  EXPECT_EQ(messages, 10U);
}

TEST(McapWriter, WhatItWroteBeforeItEndedCanBeRead) {
  const TemporaryFolder folder;
  const McapWriter writer = written(folder / "a.mcap", 10, 1'000'000);
  const auto bag = open_bag(writer.hidden_name()).value();
  EXPECT_THAT(bag->incomplete(), HasSubstr("was not closed"));
  EXPECT_GE(bag->messages().size(), 5U);
  EXPECT_EQ(bag->read(bag->messages().back()).value(),
            picture(static_cast<int>(bag->messages().size()) - 1, 1'000'000));
}

TEST(McapWriter, LeavesNothingWithoutAnEnd) {
  const TemporaryFolder folder;
  { const McapWriter writer = written(folder / "a.mcap", 1, 10); }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  EXPECT_FALSE(McapWriter::open(folder / "no/a.mcap", ""));
}

TEST(McapWriter, AFileOfNothingIsWhole) {
  const TemporaryFolder folder;
  ASSERT_TRUE(McapWriter::open(folder / "a.mcap", "").value().finish());
  EXPECT_EQ(open_bag(folder / "a.mcap").value()->incomplete(), "");
}

}  // namespace
}  // namespace ydd
