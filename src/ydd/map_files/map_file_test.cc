// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_file.h"
#include "ydd/map/compatible.h"

#include <sqlite3.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/file_lock.h"
#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
namespace tw = testing_world;
using testing::AllOf;
using testing::HasSubstr;

/// Six views of a small world with everything in it that a file must bring back: a culled keyframe,
/// freed slots, a loop, two maps, counters, pictures.
Atlas rich_atlas(int points = 150) {
  const tw::PointWorld world = tw::make_world(points, 3);
  std::vector<tw::View> views;
  for (int i = 0; i < 6; ++i) {
    tw::ViewOptions options;
    options.noise_px = 0.3;
    options.seed = static_cast<unsigned>(i) + 1;
    views.push_back(tw::look(world, tw::hand_held(0.2 * i), options));
  }
  tw::BuiltMap built = tw::build_map(world, views, 5);
  Atlas& atlas = built.atlas;
  atlas.cull_keyframe(built.keyframes[2]);
  atlas.cull_keyframe(built.keyframes[3]);
  atlas.remove_point(atlas.points().ids()[7]);
  atlas.merge_points(atlas.points().ids()[4], atlas.points().ids()[5]);
  atlas.add_loop(built.keyframes[0], built.keyframes[5]);
  atlas.count_views(atlas.points().ids()[9], 12, 4);
  KeyFrame other = tw::keyframe_of(views[1], 77);
  other.map = atlas.new_map();
  other.picture = std::make_shared<const KeyFramePicture>(
      KeyFramePicture{2, 1, std::string("j\0peg", 5), "png"});
  const KeyFrameId id = atlas.add_keyframe(std::move(other));
  atlas.add_point({0.1, -0.0, 2.0}, id, 0);
  return std::move(atlas);
}

std::string bytes_of(const fs::path& file) { return read_file(file).value(); }

void write_bytes(const fs::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
}

class MapFileTest : public testing::Test {
 protected:
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      out.push_back(entry.path().filename());
    }
    return out;
  }

  /// Loading must fail with that reason, and so must saving; the bytes stay.
  void expect_refused(const fs::path& file, const std::string& reason) {
    const std::string before = bytes_of(file);
    const Result<Atlas> loaded = load_map(file);
    ASSERT_FALSE(loaded.ok()) << reason;
    EXPECT_THAT(loaded.error().message, testing::StartsWith(file.string() + ": "));
    EXPECT_THAT(loaded.error().message, HasSubstr(reason));
    EXPECT_EQ(std::count(loaded.error().message.begin(), loaded.error().message.end(), '\n'), 0);
    EXPECT_FALSE(save_map(rich_atlas(), file).ok());
    EXPECT_TRUE(bytes_of(file) == before) << "the file was changed";
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
  fs::path file_ = folder_ / "a.map";
};

TEST_F(MapFileTest, BringsBackAnEqualAtlas) {
  Atlas atlas = rich_atlas();
  ASSERT_TRUE(save_map(atlas, file_).ok());
  EXPECT_THAT(names(), testing::ElementsAre("a.map"));
  Result<Atlas> loaded = load_map(file_);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_EQ(dump_map(*loaded), dump_map(atlas));
  EXPECT_THAT(loaded->check_consistency(), testing::IsEmpty());
  EXPECT_EQ(loaded->revision(), atlas.revision());
  EXPECT_EQ(loaded->newest_keyframe(), atlas.newest_keyframe());
  EXPECT_EQ(loaded->scales().factor, atlas.scales().factor);
  EXPECT_EQ(loaded->camera().name, atlas.camera().name);
  EXPECT_TRUE(check_same_camera(loaded->camera(), atlas.camera()).ok());
  for (const KeyFrameId id : atlas.keyframes().ids()) {
    EXPECT_EQ(loaded->at(id).points, atlas.at(id).points);
    EXPECT_EQ(loaded->map_of(id), atlas.map_of(id));
    ASSERT_TRUE(loaded->at(id).words && loaded->at(id).grid);
  }
}

TEST_F(MapFileTest, GoesOnLikeTheOneThatWasSaved) {
  Atlas atlas = rich_atlas();
  ASSERT_TRUE(save_map(atlas, file_).ok());
  Atlas loaded = load_map(file_).value();
  const tw::PointWorld world = tw::make_world(150, 3);
  for (Atlas* const each : {&atlas, &loaded}) {
    KeyFrame next = tw::keyframe_of(tw::look(world, tw::hand_held(1.4)), 99);
    next.map = each->new_map();
    const KeyFrameId id = each->add_keyframe(std::move(next));
    for (int i = 0; i < 20; ++i) each->add_point({0.1 * i, 0, 3}, id, i);
  }
  EXPECT_EQ(dump_map(loaded), dump_map(atlas));  // the same slots and generations are given out
}

TEST_F(MapFileTest, AnEmptyAtlasIsOneToo) {
  const Atlas empty(Camera(), PyramidScales::make(8, 1.2));
  ASSERT_TRUE(save_map(empty, file_).ok());
  const Result<Atlas> loaded = load_map(file_);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_TRUE(loaded->keyframes().empty());
}

TEST_F(MapFileTest, LaterSavesWriteWhatChanged) {
  Atlas atlas = rich_atlas();
  MapWriter writer = MapWriter::open(file_).value();
  const MapSave first = writer.save(atlas).value();
  EXPECT_TRUE(first.whole);
  const MapSave nothing = writer.save(atlas).value();
  EXPECT_FALSE(nothing.whole);
  EXPECT_EQ(nothing.rows, 1);
  atlas.set_pose(atlas.keyframes().ids()[1], tw::hand_held(0.7));
  atlas.count_views(atlas.points().ids()[9], 1, 1);
  EXPECT_EQ(writer.save(atlas).value().rows, 3);
  EXPECT_EQ(dump_map(load_map(file_).value()), dump_map(atlas));
  // A culled keyframe's rows go; its slot gets a new tenant.
  const KeyFrameId culled = atlas.keyframes().ids()[1];
  atlas.cull_keyframe(culled);
  KeyFrame next = tw::keyframe_of(tw::look(tw::make_world(40, 8), SE3()), 99);
  next.map = atlas.new_map();
  const KeyFrameId id = atlas.add_keyframe(std::move(next));
  atlas.add_point({0, 0, 3}, id, 0);
  EXPECT_EQ(id.slot, culled.slot);
  EXPECT_FALSE(writer.save(atlas).value().whole);
  EXPECT_EQ(dump_map(load_map(file_).value()), dump_map(atlas));
  EXPECT_THAT(names(), testing::ElementsAre("a.map"));
}

TEST_F(MapFileTest, AMapThatWasStartedAnewIsNotMixedWithTheOldOne) {
  MapWriter writer = MapWriter::open(file_).value();
  ASSERT_TRUE(writer.save(rich_atlas()).ok());
  const Atlas other = rich_atlas(90);  // the same ids, other keypoints
  EXPECT_FALSE(writer.save(other).value().whole);
  EXPECT_EQ(dump_map(load_map(file_).value()), dump_map(other));
}

TEST_F(MapFileTest, ReplacesAnotherMapWhole) {
  ASSERT_TRUE(save_map(rich_atlas(40), file_).ok());
  const Atlas atlas = rich_atlas();
  ASSERT_TRUE(save_map(atlas, file_).ok());
  EXPECT_EQ(dump_map(load_map(file_).value()), dump_map(atlas));
}

TEST_F(MapFileTest, OneWriterAtATime) {
  const Atlas atlas = rich_atlas(40);
  MapWriter writer = MapWriter::open(file_).value();
  ASSERT_TRUE(writer.save(atlas).ok());
  const Result<MapWriter> second = MapWriter::open(file_);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("another process is writing it"));
  EXPECT_TRUE(load_map(file_).ok());  // reading is open to all
}

TEST_F(MapFileTest, AFileThatWasReplacedBehindItsBackIsWrittenAnew) {
  const Atlas atlas = rich_atlas(40);
  MapWriter writer = MapWriter::open(file_).value();
  ASSERT_TRUE(writer.save(atlas).ok());
  fs::remove(file_);
  EXPECT_TRUE(writer.save(atlas).value().whole);
  EXPECT_EQ(dump_map(load_map(file_).value()), dump_map(atlas));
  fs::remove(file_);
  write_bytes(file_, "my shopping list");
  EXPECT_FALSE(writer.save(atlas).ok());
  EXPECT_EQ(bytes_of(file_), "my shopping list");
}

TEST_F(MapFileTest, TheFolderMustBeThere) {
  const Result<MapWriter> writer = MapWriter::open(folder_ / "none/a.map");
  ASSERT_FALSE(writer.ok());
  EXPECT_THAT(writer.error().message, HasSubstr("folder"));
  EXPECT_THAT(load_map(file_).error().message, HasSubstr("no such file"));
}

TEST_F(MapFileTest, AnUnfinishedSaveIsRolledBack) {
  Atlas atlas = rich_atlas(40);
  ASSERT_TRUE(save_map(atlas, file_).ok());
  // A writer that dies between changing pages and its commit: copy both files at that moment.
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &connection), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(connection,
                         "PRAGMA cache_spill = 1; PRAGMA cache_size = 1; BEGIN IMMEDIATE;"
                         "UPDATE features SET keypoints = zeroblob(60000);"
                         "UPDATE points SET points = zeroblob(60000);",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  const fs::path killed = folder_ / "killed.map";
  fs::copy_file(file_, killed);
  fs::copy_file(file_.string() + "-journal", killed.string() + "-journal");
  sqlite3_close(connection);
  ASSERT_NE(bytes_of(killed), bytes_of(file_)) << "nothing was spilled: the test tests nothing";
  const Result<Atlas> loaded = load_map(killed);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_EQ(dump_map(*loaded), dump_map(atlas));
  EXPECT_FALSE(fs::exists(killed.string() + "-journal"));
}

TEST_F(MapFileTest, WhatIsNoMapIsRefusedAndLeftAlone) {
  write_bytes(file_, "");
  expect_refused(file_, "is empty");
  write_bytes(file_,
              "a letter to my aunt, and long enough to be something else altogether ........"
              "..................................................................");
  expect_refused(file_, "is not a map file");
  write_bytes(file_, "SQLite for");
  expect_refused(file_, "cut short");
  fs::remove(file_);
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &connection), SQLITE_OK);
  sqlite3_exec(connection, "CREATE TABLE recipes(name)", nullptr, nullptr, nullptr);
  sqlite3_close(connection);
  expect_refused(file_, "another program");
}

TEST_F(MapFileTest, ANewerVersionIsRefusedAndLeftAlone) {
  ASSERT_TRUE(save_map(rich_atlas(40), file_).ok());
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &connection), SQLITE_OK);
  sqlite3_exec(connection, "PRAGMA user_version = 3", nullptr, nullptr, nullptr);
  sqlite3_close(connection);
  expect_refused(file_, "newer ydd-slam (format 3; this one reads 2)");
}

TEST_F(MapFileTest, ATruncatedFileIsRefusedAndLeftAlone) {
  ASSERT_TRUE(save_map(rich_atlas(40), file_).ok());
  const std::string whole = bytes_of(file_);
  std::mt19937 random(1);
  for (int i = 0; i < 40; ++i) {
    write_bytes(file_, whole.substr(0, 101 + random() % (whole.size() - 101)));
    expect_refused(file_, "cut short");
  }
}

TEST_F(MapFileTest, AFlippedByteIsFoundOrDoesNotMatter) {
  const Atlas atlas = rich_atlas();
  ASSERT_TRUE(save_map(atlas, file_).ok());
  const std::string whole = bytes_of(file_);
  const std::string expected = dump_map(atlas);
  std::mt19937 random(2);
  int found = 0;
  constexpr int kFlips = 300;
  for (int i = 0; i < kFlips; ++i) {
    std::string damaged = whole;
    const std::size_t at = i < 100 ? static_cast<std::size_t>(i) : random() % whole.size();
    damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1U << (random() % 8U)));
    write_bytes(file_, damaged);
    const Result<Atlas> loaded = load_map(file_);
    ASSERT_TRUE(bytes_of(file_) == damaged) << "the file was changed, byte " << at;
    if (loaded) {
      ASSERT_EQ(dump_map(*loaded), expected) << "byte " << at;
    } else {
      ++found;
    }
  }
  EXPECT_GT(found, kFlips / 2);
}

TEST_F(MapFileTest, APageOfNothingIsRefusedInOneLine) {
  ASSERT_TRUE(save_map(rich_atlas(40), file_).ok());
  const std::string whole = bytes_of(file_);
  constexpr std::size_t kPage = 4096;
  ASSERT_GE(whole.size(), 4 * kPage);
  for (std::size_t page = kPage; page < whole.size(); page += kPage) {
    SCOPED_TRACE(page / kPage);
    std::string blank = whole;
    blank.replace(page, kPage, kPage, '\0');
    write_bytes(file_, blank);
    expect_refused(file_, "is damaged");
  }
}

/// Runs SQL on a copy of a good file and expects the result to be refused.
TEST_F(MapFileTest, RowsThatDoNotBelongTogetherAreRefused) {
  ASSERT_TRUE(save_map(rich_atlas(40), file_).ok());
  const std::string whole = bytes_of(file_);
  for (const char* const sql :
       {"DELETE FROM points WHERE key = 0", "DELETE FROM keyframe WHERE key = 1",
        "DELETE FROM features WHERE key = 0", "DELETE FROM culled", "DELETE FROM atlas",
        "DROP TABLE picture", "UPDATE keyframe SET parent = 99 WHERE key = 1",
        "UPDATE keyframe SET stamp_ns = 1.5", "UPDATE points SET points = NULL",
        "UPDATE keyframe SET checksum = 0", "UPDATE atlas SET next_serial = 0",
        "UPDATE features SET keypoints = zeroblob(10)"}) {
    write_bytes(file_, whole);
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &connection), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(connection, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sql;
    sqlite3_close(connection);
    SCOPED_TRACE(sql);
    expect_refused(file_, "is damaged");
  }
}

TEST_F(MapFileTest, ACameraCalibratedAgainMayUseTheMap) {
  const auto fits = [](double Camera::*value, double change) {
    Camera again;
    again.*value += change;
    return check_same_camera(Camera(), again).ok();
  };
  EXPECT_TRUE(fits(&Camera::fx_px, 5));
  EXPECT_FALSE(fits(&Camera::fx_px, 8));
  EXPECT_TRUE(fits(&Camera::cy_px, -3.9));
  EXPECT_FALSE(fits(&Camera::cy_px, -4.1));
  EXPECT_TRUE(fits(&Camera::k1, 0.01));
  EXPECT_FALSE(fits(&Camera::k1, 0.05));
  EXPECT_FALSE(fits(&Camera::k3, -50));
  EXPECT_TRUE(fits(&Camera::baseline_m, 0.001));
  // Values that cancel out are judged by what they do together.
  Camera lens;
  lens.k1 = 0.02;
  lens.k2 = -0.06;
  EXPECT_NEAR(camera_difference_px(Camera(), Camera()), 0, 1e-9);
  EXPECT_LT(camera_difference_px(Camera(), lens), 4);
}

TEST_F(MapFileTest, AnotherCameraOrPyramidIsNamed) {
  Camera other;
  other.fx_px = 517.3;
  EXPECT_THAT(check_same_camera(Camera(), other).error().message,
              AllOf(HasSubstr("fx is 525 in the map and 517.3 now"), HasSubstr("at most 4.0 px")));
  Camera noisy;
  noisy.max_depth_m = 4;
  noisy.name = "same lens";
  EXPECT_TRUE(check_same_camera(Camera(), noisy).ok());
  Camera wide;
  wide.width_px = 848;
  EXPECT_THAT(check_same_camera(Camera(), wide).error().message, HasSubstr("width is 640"));
  Camera apart;
  apart.baseline_m *= 1.02;
  EXPECT_THAT(check_same_camera(Camera(), apart).error().message, HasSubstr("baseline is 0.15"));
  EXPECT_TRUE(check_same_scales(PyramidScales::make(8, 1.2), PyramidScales::make(8, 1.2)).ok());
  EXPECT_THAT(
      check_same_scales(PyramidScales::make(8, 1.2), PyramidScales::make(6, 1.2)).error().message,
      HasSubstr("orb.levels=8"));
}

}  // namespace
}  // namespace ydd
