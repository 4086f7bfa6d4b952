// SPDX-License-Identifier: Apache-2.0
// What a save may do to what is there, and what a file made by somebody else may do to a reader.
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"
#include "ydd/map_files/map_file.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
namespace tw = testing_world;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

/// A map that has nothing to do with one of another day.
Atlas atlas_of(int keyframes, std::int64_t day = 1) {
  const tw::PointWorld world = tw::make_world(60, 3);
  std::vector<tw::View> views;
  for (int i = 0; i < keyframes; ++i) views.push_back(tw::look(world, tw::hand_held(0.2 * i)));
  Atlas built = tw::build_map(world, views, 5).atlas;
  Atlas atlas(built.camera(), built.scales());
  for (const KeyFrameId id : built.keyframes().ids()) {
    KeyFrame keyframe = built.at(id);
    keyframe.points.clear();
    keyframe.covisible.clear();
    keyframe.parent = {};
    keyframe.map = atlas.new_map();
    keyframe.stamp.ns += day * 86'400'000'000'000;
    const KeyFrameId added = atlas.add_keyframe(std::move(keyframe));
    for (int i = 0; i < 5; ++i) atlas.add_point({0.1 * i, 0, 3}, added, i);
  }
  return atlas;
}

class MapGenerations : public testing::Test {
 protected:
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(temporary_.path())) {
      out.push_back(entry.path().filename());
    }
    return out;
  }
  void run_sql(const std::string& sql) {
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &connection), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sql << ": " << sqlite3_errmsg(connection);
    sqlite3_close(connection);
  }

  TemporaryFolder temporary_;
  fs::path file_ = temporary_.path() / "a.map";
  fs::path previous_ = temporary_.path() / "a.map.previous";
};

TEST_F(MapGenerations, AnEmptyMapReplacesNone) {
  ASSERT_TRUE(save_map(atlas_of(4), file_));
  const std::string before = read_file(file_).value();
  const Atlas empty(Camera(), PyramidScales::make(8, 1.2));
  const Result<void> saved = save_map(empty, file_);
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message, HasSubstr("holds 4 keyframes and 20 points"));
  EXPECT_TRUE(read_file(file_).value() == before);
  EXPECT_THAT(names(), UnorderedElementsAre("a.map"));
  EXPECT_TRUE(save_map(empty, file_, Replacing::anything));
  EXPECT_TRUE(load_map(file_)->keyframes().empty());
}

TEST_F(MapGenerations, AMapThatHoldsMoreIsKeptUntilTheNewOneHoldsAsMuch) {
  const Atlas good = atlas_of(4);
  ASSERT_TRUE(save_map(good, file_));
  MapWriter writer = MapWriter::open(file_).value();
  ASSERT_TRUE(writer.save(atlas_of(2, 2)));
  EXPECT_EQ(load_map(file_)->keyframes().size(), 2U);
  EXPECT_EQ(dump_map(load_map(previous_).value()), dump_map(good));
  ASSERT_TRUE(writer.save(atlas_of(3, 2)));
  EXPECT_TRUE(fs::exists(previous_));
  ASSERT_TRUE(writer.save(atlas_of(5, 2)));
  EXPECT_THAT(names(), UnorderedElementsAre("a.map"));
}

TEST_F(MapGenerations, TheLargestOfSeveralIsKept) {
  const Atlas good = atlas_of(4);
  ASSERT_TRUE(save_map(good, file_));
  ASSERT_TRUE(save_map(atlas_of(3, 2), file_));
  ASSERT_TRUE(save_map(atlas_of(2, 3), file_));
  EXPECT_EQ(dump_map(load_map(previous_).value()), dump_map(good));
  ASSERT_TRUE(save_map(atlas_of(6, 4), file_));
  ASSERT_TRUE(save_map(atlas_of(1, 5), file_));
  EXPECT_EQ(load_map(previous_)->keyframes().size(), 6U);
}

TEST_F(MapGenerations, SomethingElseOfThatNameIsNotTouched) {
  ASSERT_TRUE(save_map(atlas_of(4), file_));
  ASSERT_TRUE(write_file_atomically(previous_, "a diary"));
  const std::string before = read_file(file_).value();
  EXPECT_FALSE(save_map(atlas_of(2, 2), file_));
  EXPECT_EQ(read_file(previous_).value(), "a diary");
  EXPECT_TRUE(read_file(file_).value() == before);
}

TEST_F(MapGenerations, AMapThatWasStartedAnewInARunDoesNotTakeTheOldOneAlong) {
  const Atlas good = atlas_of(4);
  MapWriter writer = MapWriter::open(file_).value();
  ASSERT_TRUE(writer.save(good));
  ASSERT_TRUE(writer.save(atlas_of(1, 2)));
  EXPECT_EQ(dump_map(load_map(previous_).value()), dump_map(good));
}

TEST_F(MapGenerations, AMapThatGoesOnMayCull) {
  Atlas atlas = atlas_of(4);
  ASSERT_TRUE(save_map(atlas, file_));
  atlas.remove_point(atlas.points().ids()[3]);
  ASSERT_TRUE(save_map(atlas, file_));
  EXPECT_THAT(names(), UnorderedElementsAre("a.map"));
}

TEST_F(MapGenerations, ModeAndLinkStay) {
  ASSERT_TRUE(save_map(atlas_of(2), file_));
  fs::permissions(file_, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("a.map", temporary_.path() / "link.map");
  ASSERT_TRUE(save_map(atlas_of(3), temporary_.path() / "link.map"));
  EXPECT_TRUE(fs::is_symlink(temporary_.path() / "link.map"));
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(load_map(file_)->keyframes().size(), 3U);
}

TEST_F(MapGenerations, PipesAndDevicesAreNoMaps) {
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  EXPECT_FALSE(load_map(file_));
  EXPECT_FALSE(save_map(atlas_of(1), file_));
  EXPECT_FALSE(save_map(atlas_of(1), "/dev/null"));
  EXPECT_TRUE(fs::is_fifo(file_) && fs::is_character_file("/dev/null"));
}

/// What `save` says in a process whose files may have `bytes` bytes; the process ends with it.
int exit_code_of_limited_save(const Atlas& atlas, const fs::path& file, rlim_t bytes) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{bytes, bytes};
    if (::setrlimit(RLIMIT_FSIZE, &small) != 0) ::_exit(9);
    ::_exit(save_map(atlas, file) ? 0 : 1);
  }
  int status = -1;
  if (::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

TEST_F(MapGenerations, ADiskThatIsFullLeavesTheOldMap) {
  const Atlas good = atlas_of(4);
  ASSERT_TRUE(save_map(good, file_));
  const std::string before = read_file(file_).value();
  for (const rlim_t bytes : {0, 1000, 5000, 20'000}) {
    EXPECT_EQ(exit_code_of_limited_save(atlas_of(8, 2), file_, bytes), 1) << bytes;
    EXPECT_TRUE(read_file(file_).value() == before);
    EXPECT_THAT(names(), UnorderedElementsAre("a.map")) << bytes;
  }
}

TEST_F(MapGenerations, AProcessThatIsKilledLeavesOneOrTheOther) {
  const Atlas good = atlas_of(4);
  const Atlas better = atlas_of(8, 2);
  const std::string texts[] = {dump_map(good), dump_map(better)};
  std::mt19937 random(4);
  for (int i = 0; i < 30; ++i) {
    for (const auto& entry : fs::directory_iterator(temporary_.path())) fs::remove(entry.path());
    ASSERT_TRUE(save_map(good, file_));
    const pid_t child = ::fork();
    if (child == 0) {
      for (bool first = true;; first = false) {
        (void)save_map(first ? better : good, file_);
      }
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const Result<Atlas> left = load_map(file_);
    ASSERT_TRUE(left) << left.error().message;
    EXPECT_THAT(texts, testing::Contains(dump_map(*left)));
  }
}

TEST_F(MapGenerations, OnlyTheTablesOfAMapAreRead) {
  ASSERT_TRUE(save_map(atlas_of(2), file_));
  const std::string whole = read_file(file_).value();
  const std::string endless = "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c)";
  for (const std::string& sql :
       {"DROP TABLE points; CREATE VIEW points AS " + endless +
            " SELECT x AS key, x'00' AS points, 0 AS checksum FROM c",
        std::string("DROP TABLE points; CREATE VIEW points AS SELECT 1 AS key, "
                    "randomblob(900000000) AS points, 0 AS checksum"),
        std::string("CREATE VIEW v AS SELECT 1"), std::string("CREATE TABLE extra(x)"),
        std::string("CREATE INDEX i ON points(abs(key))"),
        std::string("CREATE TRIGGER t AFTER DELETE ON points BEGIN SELECT 1; END"),
        std::string("ALTER TABLE points ADD COLUMN more GENERATED ALWAYS AS (abs(key))"),
        std::string("DROP TABLE culled; CREATE TABLE culled(key INTEGER PRIMARY KEY, parent, "
                    "parent_generation, pose, checksum INTEGER, CHECK(key > 0))")}) {
    SCOPED_TRACE(sql);
    std::ofstream(file_, std::ios::binary) << whole;
    run_sql(sql);
    const Result<Atlas> loaded = load_map(file_);
    ASSERT_FALSE(loaded);
    EXPECT_THAT(loaded.error().message, HasSubstr("is no table of a map"));
    EXPECT_THAT(names(), UnorderedElementsAre("a.map"));
  }
}

TEST_F(MapGenerations, ReadingMakesNothingBesideTheFile) {
  ASSERT_TRUE(save_map(atlas_of(2), file_));
  run_sql("PRAGMA journal_mode = WAL");
  const Result<Atlas> loaded = load_map(file_);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("log beside it"));
  EXPECT_THAT(names(), UnorderedElementsAre("a.map"));
}

TEST_F(MapGenerations, AJournalThatIsALinkIsNotFollowed) {
  ASSERT_TRUE(save_map(atlas_of(2), file_));
  const fs::path victim = temporary_.path() / "victim";
  ASSERT_TRUE(write_file_atomically(victim, std::string(4096, 'v')));
  fs::create_symlink(victim, file_.string() + "-journal");
  EXPECT_THAT(load_map(file_).error().message, HasSubstr("take it away"));
  EXPECT_EQ(read_file(victim)->size(), 4096U);
}

TEST_F(MapGenerations, ADamagedFileIsAnErrorOrAConsistentMap) {
  ASSERT_TRUE(save_map(atlas_of(3), file_));
  const std::string whole = read_file(file_).value();
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string damaged = whole;
    for (unsigned flips = 1 + random() % 8; flips > 0; --flips) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    if (i % 3 == 0) damaged.resize(100 + random() % (damaged.size() - 100));
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << damaged;
    const Result<Atlas> loaded = load_map(file_);
    if (loaded) {
      EXPECT_THAT(loaded->check_consistency(), testing::IsEmpty()) << i;
    } else {
      ++refused;
    }
    EXPECT_THAT(names(), UnorderedElementsAre("a.map")) << i;
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace ydd
