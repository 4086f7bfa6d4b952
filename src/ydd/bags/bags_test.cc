// SPDX-License-Identifier: Apache-2.0
#include "ydd/bags/bag.h"

#include <algorithm>
#include <functional>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/bags/bags_testing.h"
#include "ydd/bags/byte_source.h"
#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/messages/wire_testing.h"

namespace ydd::bags {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::size_t kPictures = 5;

/// Pictures of one topic between messages of another that nobody asks for.
WrittenMessages some_messages(Wire wire) {
  const std::string package = wire == Wire::ros1 ? "sensor_msgs/" : "sensor_msgs/msg/";
  WrittenMessages out;
  for (std::size_t i = 0; i < kPictures; ++i) {
    const Timestamp stamp{static_cast<std::int64_t>(1 + i) * 1'000'000'000};
    out.push_back({"/range", package + "Range", {stamp.ns + 1}, std::string(50 + i, 'i')});
    // Larger than a page of SQLite, as pictures are.
    const std::string row(6000 + 100 * i, static_cast<char>('a' + i));
    out.push_back({"/rgb/image",
                   package + "Image",
                   {stamp.ns + 2},
                   image_message(wire, stamp, 4, 1, "rgb8", 12, row)});
  }
  return out;
}

struct Format {
  const char* name;
  const char* ending;
  Wire wire;
  std::function<void(const fs::path&, const WrittenMessages&)> write;
  friend void PrintTo(const Format& format, std::ostream* out) { *out << format.name; }
};

std::vector<Format> formats() {
  const auto ros1 = [](const std::string& compression) {
    return [compression](const fs::path& file, const WrittenMessages& messages) {
      write_bytes(file, ros1_bag(messages, compression));
    };
  };
  const auto mcap = [](const std::string& compression) {
    return [compression](const fs::path& file, const WrittenMessages& messages) {
      write_bytes(file, mcap_bag(messages, compression));
    };
  };
  const auto sqlite = [](const std::string& compression) {
    return [compression](const fs::path& file, const WrittenMessages& messages) {
      write_sqlite_bag(file, messages, compression);
    };
  };
  std::vector<Format> out = {{"ros1", ".bag", Wire::ros1, ros1("none")},
                             {"mcap", ".mcap", Wire::cdr, mcap("")},
                             {"mcap_without_chunks", ".mcap", Wire::cdr, mcap("no chunks")},
                             {"sqlite", ".db3", Wire::cdr, sqlite("")}};
#ifdef YDD_HAS_bz2
  out.push_back({"ros1_bz2", ".bag", Wire::ros1, ros1("bz2")});
#endif
#ifdef YDD_HAS_lz4
  out.push_back({"ros1_lz4", ".bag", Wire::ros1, ros1("lz4")});
  out.push_back({"mcap_lz4", ".mcap", Wire::cdr, mcap("lz4")});
#endif
#ifdef YDD_HAS_zstd
  out.push_back({"mcap_zstd", ".mcap", Wire::cdr, mcap("zstd")});
  out.push_back({"sqlite_zstd", ".db3", Wire::cdr, sqlite("zstd")});
#endif
  return out;
}

class EveryBag : public testing::TestWithParam<Format> {
 protected:
  EveryBag() { GetParam().write(file_, messages_); }

  WrittenMessages messages_ = some_messages(GetParam().wire);
  TemporaryFolder folder_;
  fs::path file_ = folder_ / (std::string("a") + GetParam().ending);
};

TEST_P(EveryBag, IsReadWhole) {
  EXPECT_TRUE(is_bag(file_));
  const auto bag = open_bag(file_);
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ((*bag)->incomplete(), "");
  ASSERT_EQ((*bag)->topics().size(), 2U);
  EXPECT_EQ((*bag)->topics()[0].name, "/range");
  EXPECT_EQ((*bag)->topics()[0].messages, kPictures);
  EXPECT_EQ((*bag)->topics()[1].type, messages_[1].type);
  EXPECT_EQ((*bag)->topics()[1].wire, GetParam().wire);
  ASSERT_EQ((*bag)->messages().size(), kPictures) << "only those of pictures";
  for (std::size_t i = 0; i < kPictures; ++i) {
    const BagMessage& message = (*bag)->messages()[i];
    EXPECT_EQ(message.topic, 1U);
    EXPECT_EQ(message.received, messages_[2 * i + 1].received);
    EXPECT_EQ(message.stamp.ns, message.received.ns - 2);
    const auto bytes = (*bag)->read(message);
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_EQ(*bytes, messages_[2 * i + 1].bytes);
  }
}

TEST_P(EveryBag, IsReadByManyAtOnce) {
  const std::shared_ptr<const Bag> bag = open_bag(file_).value();
  const auto read_all = [&](int seed) {
    for (std::size_t i = 0; i < 20; ++i) {
      const std::size_t k = (i * static_cast<std::size_t>(seed)) % kPictures;
      EXPECT_EQ(bag->read(bag->messages()[k]).value(), messages_[2 * k + 1].bytes);
    }
  };
  const std::jthread a(read_all, 1), b(read_all, 2), c(read_all, 3);
}

TEST_P(EveryBag, CutOffAnywhereItIsReadUpToThere) {
  const std::string whole = read_file(file_).value();
  const bool is_sqlite = std::string_view(GetParam().ending) == ".db3";
  std::size_t most = 0;
  for (std::size_t size = 16; size < whole.size(); size += 1 + whole.size() / 61) {
    const fs::path cut = folder_ / (std::string("cut") + GetParam().ending);
    write_bytes(cut, whole.substr(0, size));
    const auto bag = open_bag(cut);
    if (!bag) {  // SQLite's first pages tell what there is
      EXPECT_THAT(bag.error().message, AnyOf(HasSubstr("no bag of ROS 2"), HasSubstr("damaged")));
      continue;
    }
    // What comes after the last message may be missing.
    if ((*bag)->messages().size() < kPictures) {
      EXPECT_THAT((*bag)->incomplete(), AnyOf(StartsWith("is "), StartsWith("was "))) << size;
    }
    EXPECT_TRUE(is_sqlite || (*bag)->messages().size() >= most) << "more bytes, more messages";
    most = std::max(most, (*bag)->messages().size());
    for (const BagMessage& message : (*bag)->messages()) {
      const std::size_t i = static_cast<std::size_t>(message.stamp.ns / 1'000'000'000 - 1);
      EXPECT_EQ((*bag)->read(message).value(), messages_[2 * i + 1].bytes);
    }
  }
  EXPECT_GE(most, kPictures - 2);
}

TEST_P(EveryBag, DamagedAnywhereItIsReadOrRefused) {
  const std::string whole = read_file(file_).value();
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 127) {
    std::string bad = whole;
    bad[at] = static_cast<char>(~bad[at]);
    const fs::path file = folder_ / (std::string("bad") + GetParam().ending);
    write_bytes(file, bad);
    const auto bag = open_bag(file);
    if (!bag) {
      EXPECT_THAT(bag.error().message, HasSubstr(file.string()));
      continue;
    }
    for (const BagMessage& message : (*bag)->messages()) {
      static_cast<void>((*bag)->read(message).ok());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryBag, testing::ValuesIn(formats()),
                         [](const auto& test) { return std::string(test.param.name); });

/// Written by ROS 1's own library (tests/data/make-bags).
class RealBag : public testing::TestWithParam<const char*> {};

TEST_P(RealBag, IsReadWhole) {
  const auto bag = open_bag(fs::path(YDD_SOURCE_DIR) / "tests/data/bags" /
                            (std::string("ros1_") + GetParam() + ".bag"));
  ASSERT_TRUE(bag) << bag.error().message;
#ifndef YDD_HAS_lz4
  if (std::string(GetParam()) == "lz4") GTEST_SKIP();
#endif
#ifndef YDD_HAS_bz2
  if (std::string(GetParam()) == "bz2") GTEST_SKIP();
#endif
  EXPECT_EQ((*bag)->incomplete(), "");
  EXPECT_EQ((*bag)->topics().size(), 6U);
  ASSERT_EQ((*bag)->messages().size(), 18U);
  for (const BagMessage& message : (*bag)->messages()) {
    EXPECT_EQ(message.received.ns, 2'000'000'000'000);
    EXPECT_EQ(message.stamp.ns / 1'000'000'000, 100);
    EXPECT_EQ((*bag)->topics()[message.topic].messages, 3U);
    const auto bytes = (*bag)->read(message);
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_EQ(bytes->size(), message.size);
  }
}

INSTANTIATE_TEST_SUITE_P(Compressions, RealBag, testing::Values("none", "bz2", "lz4"),
                         [](const auto& test) { return std::string(test.param); });

class BagFiles : public testing::Test {
 protected:
  std::string error_of(const fs::path& path) const {
    const auto bag = open_bag(path);
    return bag ? "no error" : bag.error().message;
  }
  TemporaryFolder folder_;
};

TEST_F(BagFiles, ABagThatWasNotClosedSaysSo) {
  const WrittenMessages messages = some_messages(Wire::ros1);
  write_bytes(folder_ / "a.bag.active", ros1_bag(messages, "none", 2, false));
  EXPECT_EQ(open_bag(folder_ / "a.bag.active").value()->incomplete(),
            "was not closed by its recorder");
  write_bytes(folder_ / "a.mcap", mcap_bag(some_messages(Wire::cdr), "", "cdr", 2, false));
  EXPECT_EQ(open_bag(folder_ / "a.mcap").value()->incomplete(), "was not closed by its recorder");
}

TEST_F(BagFiles, TheFolderOfABagInSeveralFilesIsOneBag) {
  const WrittenMessages messages = some_messages(Wire::cdr);
  const WrittenMessages first(messages.begin(), messages.begin() + 4);
  const WrittenMessages rest(messages.begin() + 4, messages.end());
  // Ten comes after nine, not after one.
  write_sqlite_bag(folder_ / "walk_9.db3", first);
  write_sqlite_bag(folder_ / "walk_10.db3", rest);
  EXPECT_FALSE(is_bag(folder_.path())) << "without metadata.yaml";
  write_bytes(folder_ / "metadata.yaml", "rosbag2_bagfile_information:\n");
  EXPECT_TRUE(is_bag(folder_.path()));
  const auto bag = open_bag(folder_.path()).value();
  ASSERT_EQ(bag->topics().size(), 2U);
  EXPECT_EQ(bag->topics()[1].messages, kPictures);
  ASSERT_EQ(bag->messages().size(), kPictures);
  for (std::size_t i = 0; i < kPictures; ++i) {
    EXPECT_EQ(bag->read(bag->messages()[i]).value(), messages[2 * i + 1].bytes);
  }
  fs::resize_file(folder_ / "walk_10.db3", fs::file_size(folder_ / "walk_10.db3") - 4096);
  const auto cut = open_bag(folder_.path());
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_THAT((*cut)->incomplete(), HasSubstr("walk_10.db3 is "));
}

TEST_F(BagFiles, NothingIsWrittenBesideADatabase) {
  const fs::path file = folder_ / "50% of a #walk?.db3";
  write_sqlite_bag(file, some_messages(Wire::cdr));
  sqlite3* db = nullptr;  // as ROS 2 records with the profile "resilient"
  sqlite3_open(file.c_str(), &db);
  sqlite3_exec(db, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  const auto bag = open_bag(file);
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ((*bag)->messages().size(), kPictures);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST_F(BagFiles, AJournalThatWasLeftIsReadAsWell) {
  const fs::path file = folder_ / "a.db3";
  write_sqlite_bag(file, some_messages(Wire::cdr));
  sqlite3* db = nullptr;
  sqlite3_open(file.c_str(), &db);
  sqlite3_exec(db, "PRAGMA journal_mode = WAL; DELETE FROM messages WHERE id > 4", nullptr, nullptr,
               nullptr);
  // A copy of both, as after a power cut: closing would take the journal over.
  fs::create_directory(folder_ / "left");
  for (const char* const name : {"a.db3", "a.db3-wal"}) {
    fs::copy_file(folder_ / name, folder_ / "left" / name);
  }
  sqlite3_close(db);
  EXPECT_EQ(open_bag(folder_ / "left/a.db3").value()->messages().size(), 2U);
}

TEST_F(BagFiles, McapOfRosOneMessages) {
  write_bytes(folder_ / "a.mcap", mcap_bag(some_messages(Wire::ros1), "", "ros1"));
  const auto bag = open_bag(folder_ / "a.mcap").value();
  EXPECT_EQ(bag->topics()[1].wire, Wire::ros1);
  EXPECT_EQ(bag->messages()[3].stamp.ns, 4'000'000'000);
  // Of others nothing is known but the name.
  write_bytes(folder_ / "b.mcap", mcap_bag(some_messages(Wire::cdr), "", "protobuf"));
  const auto other = open_bag(folder_ / "b.mcap").value();
  EXPECT_EQ(other->topics()[1].type, "sensor_msgs/msg/Image as protobuf");
  EXPECT_TRUE(other->messages().empty());
}

TEST_F(BagFiles, WhatIsNoBagIsRefusedWithTheWayOut) {
  write_bytes(folder_ / "a.bag", "#ROSBAG V1.2\n");
  EXPECT_THAT(error_of(folder_ / "a.bag"), HasSubstr("old format; 'rosbag fix'"));
  write_bytes(folder_ / "b.mcap.zstd", "\x28\xB5\x2F\xFD whatever");
  EXPECT_THAT(error_of(folder_ / "b.mcap.zstd"), HasSubstr("unpack it first (zstd -d)"));
  write_bytes(folder_ / "c.bag", "hello");
  EXPECT_THAT(error_of(folder_ / "c.bag"), HasSubstr("is no bag of ROS 1 or 2"));
  EXPECT_FALSE(is_bag(folder_ / "c.bag"));
  fs::create_directory(folder_ / "empty");
  EXPECT_THAT(error_of(folder_ / "empty"), HasSubstr("holds no bag of ROS 2"));
  EXPECT_FALSE(is_bag(folder_ / "nothing"));
  sqlite3* db = nullptr;
  sqlite3_open((folder_ / "d.db3").c_str(), &db);
  sqlite3_exec(db,
               "CREATE TABLE topics(id); CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 "
               "UNION ALL SELECT i FROM n) SELECT i AS id, 1 AS topic_id, 1 AS timestamp FROM n",
               nullptr, nullptr, nullptr);
  sqlite3_close(db);
  EXPECT_THAT(error_of(folder_ / "d.db3"), HasSubstr("no bag of ROS 2"));
}

TEST(Decompress, WhatIsUnknownOrTooMuchIsRefused) {
  EXPECT_THAT(decompressed("snappy", "x", 1).error().message, HasSubstr("'snappy'"));
  EXPECT_THAT(decompressed("lz4", "x", kLargestPiece + 1).error().message,
              HasSubstr("1 bytes that say they become"));
  EXPECT_FALSE(decompressed("lz4", "xxxx", 4));
  EXPECT_FALSE(decompressed("bz2", "xxxx", 4));
  EXPECT_FALSE(decompressed("zstd", "xxxx", 4));
}

#ifdef YDD_HAS_lz4
TEST(Decompress, AnotherSizeThanItSaysIsDamage) {
  const std::string text(1000, 'x');
  EXPECT_EQ(decompressed("lz4", packed("lz4", text), 1000).value(), text);
  EXPECT_FALSE(decompressed("lz4", packed("lz4", text), 999));
  EXPECT_FALSE(decompressed("lz4", packed("lz4", text), 1001));
}
#endif

TEST(BagBytes, TheWindowGivesWhatIsThere) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += fmt::format("{:05} ", i);
  write_bytes(folder / "a", text);
  const BagFile file = BagFile::open(folder / "a").value();
  ByteSource bytes(file);
  for (const std::uint64_t offset : {0UL, 6UL, 16380UL, 100'000UL, 90'000UL, 119'994UL}) {
    EXPECT_EQ(bytes.at(offset, 6), text.substr(offset, 6)) << offset;
  }
  EXPECT_EQ(bytes.at(10, 50'000), text.substr(10, 50'000));
  EXPECT_FALSE(bytes.at(119'995, 6));
  EXPECT_FALSE(bytes.at(~std::uint64_t{0}, 6));
  EXPECT_FALSE(BagFile::open(folder.path()));
}

}  // namespace
}  // namespace ydd::bags
