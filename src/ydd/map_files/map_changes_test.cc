// SPDX-License-Identifier: Apache-2.0
// A save writes what has changed since the last, and the file holds all of it.
#include <sys/stat.h>

#include <random>

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

/// A map that is edited as mapping edits one, at random and by a seed.
class EditedMap {
 public:
  explicit EditedMap(unsigned seed, int keyframes = 12)
      : world_(tw::make_world(200, seed)), random_(seed), built_(build(keyframes)) {}

  Atlas& atlas() { return built_.atlas; }

  void edit() {
    switch (random_() % 8) {
      case 0:
        return add_keyframe();
      case 1:
        return cull_keyframe();
      case 2:
        return built_.atlas.set_pose(some_keyframe(), tw::hand_held(0.01 * tick(100)));
      case 3:
        return built_.atlas.set_position(some_point(), {0.1 * tick(10), 0, 3});
      case 4:
        return built_.atlas.remove_point(some_point());
      case 5:
        return built_.atlas.count_views(some_point(), 2, 1);
      case 6:
        return built_.atlas.merge_points(some_point(), some_point());
      default:
        return add_points();
    }
  }

 private:
  tw::BuiltMap build(int keyframes) const {
    std::vector<tw::View> views;
    for (int i = 0; i < keyframes; ++i) {
      views.push_back(tw::look(world_, tw::hand_held(0.2 * i)));
    }
    return tw::build_map(world_, views, 5);
  }
  std::size_t pick(std::size_t end) { return random_() % end; }
  double tick(std::size_t end) { return static_cast<double>(pick(end)); }
  KeyFrameId some_keyframe() {
    const auto ids = built_.atlas.keyframes().ids();
    return ids[pick(ids.size())];
  }
  MapPointId some_point() {
    const auto ids = built_.atlas.points().ids();
    return ids[pick(ids.size())];
  }

  void add_keyframe() {
    KeyFrame k = tw::keyframe_of(tw::look(world_, tw::hand_held(0.01 * tick(300))),
                                 static_cast<std::int64_t>(1000 + pick(1000)));
    const KeyFrameId beside = some_keyframe();
    k.map = built_.atlas.at(beside).map;
    k.parent = beside;
    if (pick(2) == 0) {
      k.picture = std::make_shared<const KeyFramePicture>(KeyFramePicture{2, 1, "jpeg", "png"});
    }
    const KeyFrameId id = built_.atlas.add_keyframe(std::move(k));
    built_.atlas.add_point({0, 0, 2}, id, 0);
    built_.atlas.refresh_covisibility(id, 5);
  }
  void add_points() {
    const KeyFrameId id = some_keyframe();
    for (int i = 0; i < 5; ++i) {
      const auto keypoint = pick(built_.atlas.at(id).points.size());
      if (!built_.atlas.at(id).points[keypoint].valid()) {
        built_.atlas.add_point({0, 0.1 * i, 2}, id, static_cast<int>(keypoint));
      }
    }
  }
  void cull_keyframe() {
    const KeyFrameId id = some_keyframe();
    if (!built_.atlas.is_first(id) && built_.atlas.keyframes().size() > 4) {
      built_.atlas.cull_keyframe(id);
    }
  }

  tw::PointWorld world_;
  std::mt19937_64 random_;
  tw::BuiltMap built_;
};

ino_t inode(const fs::path& file) {
  struct stat status {};
  EXPECT_EQ(::stat(file.c_str(), &status), 0);
  return status.st_ino;
}

class MapChanges : public testing::Test {
 protected:
  MapWriter open() {
    Result<MapWriter> writer = MapWriter::open(file_);
    EXPECT_TRUE(writer.ok()) << writer.error().message;
    return std::move(*writer);
  }
  void expect_in_file(const Atlas& atlas) {
    const Result<Atlas> loaded = load_map(file_);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    EXPECT_EQ(dump_map(*loaded), dump_map(atlas));
  }

  TemporaryFolder temporary_;
  fs::path file_ = temporary_.path() / "a.map";
};

TEST_F(MapChanges, OfSnapshotsAreAllThatIsWrittenAndNothingIsMissed) {
  EditedMap map(1);
  EditedMap same(1);
  MapWriter writer = open();
  // The same map without snapshots: each row is made and compared.
  const fs::path other_file = temporary_.path() / "b.map";
  MapWriter other = MapWriter::open(other_file).value();
  for (int save = 0; save < 40; ++save) {
    const auto snapshot = map.atlas().snapshot();
    const Result<MapSave> saved = writer.save(snapshot);
    const Result<MapSave> compared = other.save(same.atlas());
    ASSERT_TRUE(saved.ok() && compared.ok());
    EXPECT_EQ(saved->whole, save == 0);
    EXPECT_EQ(saved->rows, compared->rows) << "save " << save;
    expect_in_file(*snapshot);
    for (int i = 0; i < save % 7; ++i) {
      map.edit();
      same.edit();
    }
  }
}

TEST_F(MapChanges, OfAMapThatWasReadFromTheFileGoIntoIt) {
  EditedMap map(2, 20);
  ASSERT_TRUE(save_map(map.atlas(), file_).ok());
  const ino_t file = inode(file_);
  for (int day = 0; day < 3; ++day) {
    Atlas atlas = load_map(file_).value();
    MapWriter writer = open();
    const Result<MapSave> nothing = writer.save(atlas.snapshot());
    ASSERT_TRUE(nothing.ok());
    EXPECT_FALSE(nothing->whole);
    EXPECT_EQ(nothing->rows, 1);
    atlas.set_pose(atlas.keyframes().ids()[1], tw::hand_held(0.3 + day));
    atlas.cull_keyframe(atlas.keyframes().ids()[5]);
    const Result<MapSave> saved = writer.save(atlas.snapshot());
    ASSERT_TRUE(saved.ok());
    EXPECT_FALSE(saved->whole);
    EXPECT_LT(saved->rows, 40);
    EXPECT_EQ(inode(file_), file);
    expect_in_file(atlas);
  }
}

TEST_F(MapChanges, OfAnotherMapMakeANewFile) {
  EditedMap map(3);
  ASSERT_TRUE(save_map(map.atlas(), file_).ok());
  EditedMap other(4, 14);  // of as much, and the same ids
  Atlas shifted(other.atlas().camera(), other.atlas().scales());
  for (const KeyFrameId id : other.atlas().keyframes().ids()) {
    KeyFrame k = other.atlas().at(id);
    k.stamp.ns += 86'400'000'000'000;
    k.points.clear();
    k.parent = {};
    k.map = shifted.new_map();
    const KeyFrameId added = shifted.add_keyframe(std::move(k));
    for (int i = 0; i < 40; ++i) shifted.add_point({0, 0, 3}, added, i);
  }
  const ino_t file = inode(file_);
  MapWriter writer = MapWriter::open(file_, Replacing::anything).value();
  const Result<MapSave> saved = writer.save(shifted.snapshot());
  ASSERT_TRUE(saved.ok());
  EXPECT_TRUE(saved->whole);
  EXPECT_NE(inode(file_), file);
  expect_in_file(shifted);
  // From here on it is the map in the file, whatever becomes of it.
  EXPECT_FALSE(writer.save(map.atlas().snapshot())->whole);
  expect_in_file(map.atlas());
}

TEST_F(MapChanges, AfterASaveThatFailedTheWholeMapIsWritten) {
  EditedMap map(5);
  MapWriter writer = open();
  ASSERT_TRUE(writer.save(map.atlas().snapshot()).ok());
  fs::remove(file_);
  ASSERT_TRUE(write_file_atomically(file_, "my shopping list").ok());
  map.edit();
  EXPECT_FALSE(writer.save(map.atlas().snapshot()).ok());
  fs::remove(file_);
  map.edit();
  const auto snapshot = map.atlas().snapshot();
  const Result<MapSave> saved = writer.save(snapshot);
  ASSERT_TRUE(saved.ok()) << saved.error().message;
  EXPECT_TRUE(saved->whole);
  expect_in_file(*snapshot);
}

}  // namespace
}  // namespace ydd
