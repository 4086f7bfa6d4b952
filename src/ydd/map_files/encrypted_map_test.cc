// SPDX-License-Identifier: Apache-2.0
#include <sqlite3.h>
#include <sys/stat.h>

#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"
#include "ydd/map_files/database.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_schema.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
namespace tw = testing_world;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::string_view kHex =
    "00112233445566778899aabbccddeeff00112233445566778899AABBCCDDEEFF";
constexpr std::string_view kOtherHex =
    "ff112233445566778899aabbccddeeff00112233445566778899aabbccddeeff";

Atlas seen_atlas(int views) {
  const tw::PointWorld world = tw::make_world(150, 3);
  std::vector<tw::View> seen;
  for (int i = 0; i < views; ++i) {
    tw::ViewOptions options;
    options.seed = static_cast<unsigned>(i) + 1;
    seen.push_back(tw::look(world, tw::hand_held(0.2 * i), options));
  }
  return tw::build_map(world, seen, 5).atlas;
}

std::string all_of(const fs::path& file) { return read_file(file).value(); }

void put_bytes(const fs::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
}

class EncryptedMapTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!why_no_encryption().empty()) GTEST_SKIP() << why_no_encryption();
    ASSERT_TRUE(save_map(atlas_, file_, Replacing::lesser, key_).ok());
  }

  std::string why_not(const MapKey& key) const {
    const Result<Atlas> loaded = load_map(file_, key);
    if (loaded) return "";
    EXPECT_FALSE(check_map(file_, key).faults.empty());
    EXPECT_EQ(std::ranges::count(loaded.error().message, '\n'), 0);
    EXPECT_THAT(loaded.error().message, testing::StartsWith(file_.string() + ": "));
    return loaded.error().message;
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
  fs::path file_ = folder_ / "a.map";
  MapKey key_ = MapKey::of(kHex).value();
  Atlas atlas_ = seen_atlas(4);
};

std::string descriptor_of(const KeyFrame& keyframe) {
  const auto& descriptor = keyframe.features().descriptors.front();
  return {reinterpret_cast<const char*>(&descriptor), sizeof(descriptor)};
}

/// Whether it is anywhere in any file of the folder.
bool anywhere(const fs::path& folder, std::string_view bytes) {
  return std::ranges::any_of(fs::directory_iterator(folder), [&](const fs::directory_entry& e) {
    return all_of(e.path()).find(bytes) != std::string::npos;
  });
}

TEST_F(EncryptedMapTest, BringsBackAnEqualAtlasAndShowsNothing) {
  const Result<Atlas> loaded = load_map(file_, key_);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_EQ(dump_map(*loaded), dump_map(atlas_));
  const MapCheck check = check_map(file_, key_);
  EXPECT_THAT(check.faults, testing::IsEmpty());
  EXPECT_EQ(check.keyframes, atlas_.keyframes().size());
  // What a plain one begins with and is full of; a keyframe's descriptors stand for its content.
  ASSERT_TRUE(save_map(atlas_, folder_ / "b.map").ok());
  const std::string bits = descriptor_of(*atlas_.find(atlas_.keyframes().ids().front()));
  for (const std::string_view shown : {std::string_view("SQLite format 3"),
                                       std::string_view("CREATE TABLE"), std::string_view(bits)}) {
    EXPECT_NE(all_of(folder_ / "b.map").find(shown), std::string::npos);
    EXPECT_EQ(all_of(file_).find(shown), std::string::npos);
  }
}

TEST_F(EncryptedMapTest, JournalIsEncryptedWhileItIsThere) {
  {
    map_format::Database database(file_, map_format::Database::Mode::write, key_);
    EXPECT_EQ(database.number("PRAGMA temp_store"), 2);  // memory
    // A page cache of one page makes it write to the disk before the end.
    database.run("PRAGMA cache_size = 1; BEGIN IMMEDIATE");
    database.run("UPDATE features SET keypoints = zeroblob(100000)");
    ASSERT_TRUE(fs::exists(file_.string() + "-journal"));
    EXPECT_GT(fs::file_size(file_.string() + "-journal"), 4096U);
    EXPECT_FALSE(anywhere(folder_, "SQLite format 3"));
    EXPECT_FALSE(anywhere(folder_, "CREATE TABLE"));
    for (const KeyFrameId id : atlas_.keyframes().ids()) {  // what the old pages are full of
      EXPECT_FALSE(anywhere(folder_, descriptor_of(*atlas_.find(id))));
    }
    database.run("ROLLBACK");
  }
  EXPECT_EQ(dump_map(load_map(file_, key_).value()), dump_map(atlas_));
}

TEST_F(EncryptedMapTest, SavesWhatChangedAndKeepsALargerOne) {
  MapWriter writer = MapWriter::open(file_, Replacing::lesser, key_).value();
  Atlas changed = load_map(file_, key_).value();
  changed.set_pose(changed.keyframes().ids()[1], tw::hand_held(0.7));
  const MapSave saved = writer.save(changed).value();
  EXPECT_FALSE(saved.whole);
  EXPECT_EQ(dump_map(load_map(file_, key_).value()), dump_map(changed));
  const Result<MapSave> lesser = writer.save(seen_atlas(2));
  ASSERT_TRUE(lesser.ok()) << lesser.error().message;
  EXPECT_TRUE(lesser->whole);
  EXPECT_EQ(dump_map(load_map(file_.string() + ".previous", key_).value()), dump_map(changed));
  EXPECT_FALSE(load_map(file_.string() + ".previous").ok()) << "the one before is encrypted too";
}

TEST_F(EncryptedMapTest, TellsWrongMissingAndNeedlessKeysFromDamage) {
  testing::internal::CaptureStderr();  // SQLCipher would tell it once more
  const std::string before = all_of(file_);
  EXPECT_THAT(why_not(MapKey::of(kOtherHex).value()),
              AllOf(HasSubstr("does not open with this key"), Not(HasSubstr("is damaged"))));
  EXPECT_THAT(why_not(MapKey::of("a phrase").value()), HasSubstr("does not open with this key"));
  EXPECT_THAT(why_not({}), AllOf(HasSubstr("is encrypted, or no map file"), HasSubstr("--map-key"),
                                 Not(HasSubstr("is damaged"))));
  for (const MapKey& key : {MapKey(), MapKey::of(kOtherHex).value()}) {
    EXPECT_FALSE(save_map(atlas_, file_, Replacing::anything, key).ok());
  }
  EXPECT_TRUE(all_of(file_) == before);
  const fs::path plain = folder_ / "plain.map";
  ASSERT_TRUE(save_map(atlas_, plain).ok());
  EXPECT_THAT(load_map(plain, key_).error().message,
              AllOf(HasSubstr("is not encrypted"), HasSubstr("map encrypt")));
  EXPECT_FALSE(save_map(atlas_, plain, Replacing::anything, key_).ok());
  EXPECT_TRUE(load_map(plain).ok());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(EncryptedMapTest, DamageIsDamage) {
  const std::string sound = all_of(file_);
  std::mt19937 random(7);
  for (int i = 0; i < 12; ++i) {
    std::string changed = sound;
    const std::size_t at = 4096 + random() % (sound.size() - 4096);
    changed[at] = static_cast<char>(changed[at] ^ (1 << random() % 8));
    put_bytes(file_, changed);
    EXPECT_THAT(why_not(key_), HasSubstr("is damaged")) << at;
  }
  put_bytes(file_, sound.substr(0, sound.size() / 4096 / 2 * 4096));
  EXPECT_THAT(why_not(key_), HasSubstr("is damaged"));
  put_bytes(file_, sound.substr(0, sound.size() - 100));
  EXPECT_THAT(why_not(key_), HasSubstr("is damaged"));
  put_bytes(file_, sound.substr(0, 100));
  EXPECT_THAT(why_not(key_), HasSubstr("is not a map file"));
  put_bytes(file_, std::string(8192, 'x'));
  EXPECT_THAT(why_not(key_), HasSubstr("is not a map file"));
  EXPECT_THAT(why_not({}), HasSubstr("is not a map file"));
}

TEST_F(EncryptedMapTest, AKilledSaveIsRolledBackByItsKeyOnly) {
  const std::string before = all_of(file_);
  const fs::path journal = file_.string() + "-journal";
  {
    map_format::Database database(file_, map_format::Database::Mode::write, key_);
    database.run("PRAGMA cache_size = 1; BEGIN IMMEDIATE");
    database.run("UPDATE features SET keypoints = zeroblob(100000)");
    // As a kill would leave it.
    fs::copy_file(file_, folder_ / "killed.map");
    fs::copy_file(journal, folder_ / "killed.map-journal");
    database.run("ROLLBACK");
  }
  const fs::path killed = folder_ / "killed.map";
  ASSERT_NE(all_of(killed), before);
  const auto wrong = load_map(killed, MapKey::of(kOtherHex).value());
  ASSERT_FALSE(wrong.ok());
  EXPECT_THAT(wrong.error().message, HasSubstr("does not open with this key"));
  const Result<Atlas> loaded = load_map(killed, key_);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_EQ(dump_map(*loaded), dump_map(atlas_));
}

TEST_F(EncryptedMapTest, BesidePlainDatabasesOfTheSameProcess) {
  // One of each open at a time, calls in turn: as a bag is read while a map is saved.
  const fs::path plain = folder_ / "bag.db3";
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(plain.c_str(), &raw), SQLITE_OK);
  map_format::Database encrypted(file_, map_format::Database::Mode::write, key_);
  ASSERT_EQ(sqlite3_exec(raw, "CREATE TABLE t(a); BEGIN", nullptr, nullptr, nullptr), SQLITE_OK);
  encrypted.run("BEGIN IMMEDIATE");
  for (int i = 0; i < 100; ++i) {
    const std::string row = fmt::format("INSERT INTO t VALUES({})", i);
    ASSERT_EQ(sqlite3_exec(raw, row.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    EXPECT_EQ(encrypted.number("SELECT count(*) FROM keyframe"), 4);
  }
  encrypted.run("COMMIT");
  ASSERT_EQ(sqlite3_exec(raw, "COMMIT", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_EQ(sqlite3_close(raw), SQLITE_OK);
  EXPECT_THAT(all_of(plain), testing::StartsWith("SQLite format 3"));
  // Each library is itself: only one of them knows what a cipher is.
  map_format::Database other(plain, map_format::Database::Mode::read);
  EXPECT_EQ(other.text("SELECT sqlite_version()"), sqlite3_libversion());
  EXPECT_THAT(other.texts("PRAGMA cipher_version"), testing::IsEmpty());
  EXPECT_THAT(encrypted.text("PRAGMA cipher_version"), Not(testing::IsEmpty()));
}

TEST_F(EncryptedMapTest, ConvertsToAnyKeyAndBack) {
  const MapKey other = MapKey::of("a pass phrase").value();
  const fs::path plain = folder_ / "plain.map";
  ASSERT_TRUE(convert_map(file_, key_, plain, {}).ok());
  EXPECT_EQ(dump_map(load_map(plain).value()), dump_map(atlas_));
  EXPECT_TRUE(load_map(file_, key_).ok());
  ASSERT_TRUE(convert_map(plain, {}, plain, other).ok()) << "in place";
  EXPECT_EQ(dump_map(load_map(plain, other).value()), dump_map(atlas_));
  EXPECT_FALSE(load_map(plain).ok());
  ASSERT_TRUE(convert_map(plain, other, plain, key_).ok()) << "another key";
  EXPECT_TRUE(check_map(plain, key_).faults.empty());
  EXPECT_THAT(convert_map(plain, other, plain, {}).error().message,
              HasSubstr("does not open with this key"));
  EXPECT_THAT(convert_map(plain, key_, file_, {}).error().message, HasSubstr("is there already"));
  EXPECT_EQ(std::ranges::distance(fs::directory_iterator(folder_)), 2) << "nothing is left behind";
  std::string damaged = all_of(file_);
  damaged[damaged.size() - 2000] ^= 1;
  put_bytes(file_, damaged);
  EXPECT_THAT(convert_map(file_, key_, folder_ / "c.map", {}).error().message,
              HasSubstr("is damaged"));
  EXPECT_FALSE(fs::exists(folder_ / "c.map"));
}

TEST(MapKeyTest, IsReadFromAFileOfItsOwnerAlone) {
  const TemporaryFolder temporary;
  const fs::path file = temporary.path() / "key";
  const auto read = [&](std::string_view content, unsigned mode) {
    put_bytes(file, content);
    EXPECT_EQ(::chmod(file.c_str(), mode), 0);
    return MapKey::read(file);
  };
  EXPECT_EQ(read(kHex, 0600).value(), MapKey::of(kHex).value());
  EXPECT_EQ(read(" \t" + std::string(kHex) + "\r\n", 0640).value(), MapKey::of(kHex).value());
  EXPECT_TRUE(MapKey::of(kHex)->is_raw());
  EXPECT_FALSE(MapKey::of(kHex.substr(1))->is_raw()) << "63 digits are a phrase";
  EXPECT_FALSE(MapKey::of("pass phrase")->is_raw());
  const auto reason = [&](std::string_view content, unsigned mode) {
    const Result<MapKey> key = read(content, mode);
    EXPECT_FALSE(key.ok());
    if (key) return std::string();
    EXPECT_THAT(key.error().message,
                AllOf(testing::StartsWith(file.string() + ": "), Not(HasSubstr("secret"))));
    return key.error().message;
  };
  EXPECT_THAT(reason(" \n", 0600), HasSubstr("is empty"));
  EXPECT_THAT(reason("secret", 0604), HasSubstr("chmod 600"));
  EXPECT_THAT(reason(std::string(5000, 's'), 0600), HasSubstr("larger"));
  EXPECT_EQ(MapKey::of(std::string(4096, 's'))->bytes().size(), 4096U);
  EXPECT_THAT(MapKey::read(temporary.path() / "none").error().message, HasSubstr("none: "));
  EXPECT_FALSE(MapKey::read(temporary.path()).ok()) << "a folder";
}

TEST(MapKeyTest, ComesFromTheEnvironmentWhereNothingElseIsNamed) {
  const TemporaryFolder temporary;
  const fs::path file = temporary.path() / "key";
  put_bytes(file, kHex);
  ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
  // NOLINTBEGIN(concurrency-mt-unsafe): there is one thread
  ASSERT_EQ(::unsetenv("YDD_MAP_KEY_FILE"), 0);
  EXPECT_FALSE(MapKey::find("").value());
  ASSERT_EQ(::setenv("YDD_MAP_KEY_FILE", file.c_str(), 1), 0);
  EXPECT_EQ(MapKey::find("").value(), MapKey::of(kHex).value());
  EXPECT_FALSE(MapKey::find(temporary.path() / "none").ok()) << "the option counts more";
  ASSERT_EQ(::setenv("YDD_MAP_KEY_FILE", (temporary.path() / "none").c_str(), 1), 0);
  EXPECT_THAT(MapKey::find("").error().message, HasSubstr("YDD_MAP_KEY_FILE"));
  ASSERT_EQ(::unsetenv("YDD_MAP_KEY_FILE"), 0);
  // NOLINTEND(concurrency-mt-unsafe)
}

}  // namespace
}  // namespace ydd
