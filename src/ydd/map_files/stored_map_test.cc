// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/stored_map.h"

#include <sqlite3.h>

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"
#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"
#include "ydd/map_files/map_file.h"
#include "ydd/map_files/map_schema.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
namespace tw = testing_world;
using testing::HasSubstr;

/// A walk past one world, whose keyframes have words.
Atlas walked_atlas(int views = 12) {
  const tw::PointWorld world = tw::make_world(300, 3);
  std::vector<tw::View> looks;
  for (int i = 0; i < views; ++i) looks.push_back(tw::look(world, tw::hand_held(0.3 * i)));
  tw::BuiltMap built = tw::build_map(world, looks, 5);
  AtlasParts parts;
  parts.camera = built.atlas.camera();
  parts.scales = built.atlas.scales();
  built.atlas.add_loop(built.keyframes[3], built.keyframes[4]);  // names one that is culled next
  built.atlas.cull_keyframe(built.keyframes[4]);
  built.atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    KeyFrame with_words = keyframe;
    with_words.words = std::make_shared<const BagOfWords>(
        bag_of_words(builtin_vocabulary(), keyframe.features().descriptors));
    parts.keyframes.emplace_back(id, std::move(with_words));
  });
  built.atlas.points().for_each(
      [&](MapPointId id, const MapPoint& point) { parts.points.emplace_back(id, point); });
  parts.freed_keyframes = built.atlas.keyframes().freed();
  parts.freed_points = built.atlas.points().freed();
  built.atlas.culled().for_each(
      [&](KeyFrameId id, const CulledKeyFrame& culled) { parts.culled[id] = culled; });
  parts.revision = built.atlas.revision();
  parts.newest = built.atlas.newest_keyframe();
  parts.next_serial = built.atlas.next_serial();
  parts.maps = built.atlas.maps();
  return Atlas::restore(std::move(parts)).value();
}

class StoredMapTest : public testing::Test {
 protected:
  StoredMapTest() { EXPECT_TRUE(save_map(whole_, file_).ok()); }
  StoredMap open() { return StoredMap::open(file_).value(); }
  std::set<KeyFrameId> every(std::size_t step, std::size_t from = 0) const {
    std::set<KeyFrameId> out;
    const auto ids = whole_.keyframes().ids();
    for (std::size_t i = from; i < ids.size(); i += step) out.insert(ids[i]);
    return out;
  }
  void run_sql(const char* sql) {
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &connection), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(connection, sql, nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(connection);
  }

  TemporaryFolder temporary_;
  fs::path file_ = temporary_.path() / "a.map";
  Atlas whole_ = walked_atlas();
};

/// A part is the whole without what the others saw.
void expect_part(const Atlas& part, const Atlas& whole, const std::set<KeyFrameId>& wanted) {
  ASSERT_EQ(part.keyframes().size(), wanted.size());
  std::set<MapPointId> seen;
  for (const KeyFrameId id : wanted) {
    const KeyFrame* const here = part.find(id);
    const KeyFrame& there = whole.at(id);
    ASSERT_NE(here, nullptr);
    EXPECT_EQ(here->points, there.points);
    EXPECT_EQ(here->covisible, there.covisible);
    EXPECT_EQ(here->parent, there.parent);
    EXPECT_EQ(here->T_world_camera.matrix(), there.T_world_camera.matrix());
    EXPECT_EQ(here->features().descriptors, there.features().descriptors);
    EXPECT_EQ(here->words->words, there.words->words);
    EXPECT_EQ(here->words->weights, there.words->weights);
    for (const MapPointId point : there.points) {
      if (point.valid()) seen.insert(point);
    }
  }
  EXPECT_EQ(part.points().size(), seen.size());
  EXPECT_EQ(part.points().slots(), whole.points().slots());
  EXPECT_EQ(part.word_index().size(), wanted.size());
  for (const MapPointId id : seen) {
    ASSERT_TRUE(part.find(id));
    std::vector<Observation> expected = whole.at(id).observations;
    std::erase_if(expected, [&](const auto& o) { return !wanted.contains(o.keyframe); });
    EXPECT_EQ(part.at(id).observations, expected);
    EXPECT_EQ(part.at(id).p_world, whole.at(id).p_world);
    EXPECT_EQ(part.at(id).descriptor, whole.at(id).descriptor);
  }
}

TEST_F(StoredMapTest, APartIsTheWholeWithoutWhatOthersSaw) {
  StoredMap stored = open();
  EXPECT_TRUE(stored.has_parts());
  EXPECT_EQ(stored.keyframes(), whole_.keyframes().size());
  EXPECT_EQ(stored.newest_keyframe(), whole_.newest_keyframe());
  for (const auto& wanted : {every(3), every(2, 1), every(1), every(4)}) {
    const auto part = stored.part(wanted);
    ASSERT_TRUE(part.ok()) << part.error().message;
    expect_part(**part, whole_, wanted);
  }
}

TEST_F(StoredMapTest, WhoWasInAnEarlierPartKeepsItsPlace) {
  StoredMap stored = open();
  ASSERT_TRUE(stored.part(every(2)).ok());
  const auto part = stored.part(every(2, 1)).value();
  const KeyFrameId gone = *every(2).begin();
  EXPECT_FALSE(part->find(gone));
  ASSERT_TRUE(part->T_world_keyframe(gone));
  EXPECT_EQ(part->T_world_keyframe(gone)->matrix(), whole_.at(gone).T_world_camera.matrix());
  EXPECT_EQ(part->map_of(gone), whole_.map_of(gone));
  EXPECT_FALSE(part->nearest_kept(gone).valid());
}

/// All but what is told of culled keyframes, which no part has.
std::string dump_without_culled(const Atlas& atlas) {
  std::istringstream lines(dump_map(atlas));
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("culled ")) out += line + "\n";
  }
  return out;
}

TEST_F(StoredMapTest, AllOfItIsWhatALoadGives) {
  const auto part = open().part(every(1)).value();
  const Atlas loaded = load_map(file_).value();
  EXPECT_TRUE(dump_without_culled(*part) == dump_without_culled(loaded));
}

TEST_F(StoredMapTest, AnswersWhoIsNear) {
  StoredMap stored = open();
  const KeyFrameId centre = whole_.newest_keyframe();
  const auto near = stored.neighbourhood({&centre, 1}, 4).value();
  ASSERT_EQ(near.size(), 4U);
  EXPECT_EQ(near.front(), centre);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(near[i + 1], whole_.at(centre).covisible[i].keyframe);
  }
  EXPECT_EQ(stored.neighbourhood({&centre, 1}, 1000).value().size(), whole_.keyframes().size());
}

TEST_F(StoredMapTest, TheIndexListsEveryKeyframe) {
  StoredMap stored = open();
  const WordIndex index = stored.word_index(1'000'000).value();
  EXPECT_TRUE(index.complete());
  EXPECT_EQ(index.size(), whole_.keyframes().size());
  const WordIndex short_one = stored.word_index(50 * index.size()).value();
  EXPECT_FALSE(short_one.complete());
  EXPECT_EQ(short_one.size(), index.size());
  for (const auto& entry : index.entries()) {
    EXPECT_EQ(entry.words, nullptr);
    EXPECT_EQ(stored.words(entry.keyframe)->weights, whole_.at(entry.keyframe).words->weights);
  }
}

TEST_F(StoredMapTest, DamageOfAPartIsFoundWhenItIsRead) {
  run_sql("UPDATE features SET keypoints = zeroblob(200) WHERE key = 2");
  StoredMap stored = open();
  std::set<KeyFrameId> sound = every(1);
  const auto damaged =
      std::find_if(sound.begin(), sound.end(), [](auto id) { return id.slot == 2; });
  ASSERT_NE(damaged, sound.end());
  const auto part = stored.part(sound);
  ASSERT_FALSE(part.ok());
  EXPECT_THAT(part.error().message, HasSubstr("a.map: is damaged (table features, row 2"));
  sound.erase(damaged);
  EXPECT_TRUE(stored.part(sound).ok()) << "what is sound can still be read";
}

TEST_F(StoredMapTest, RowsThatAreMissingAreNamed) {
  run_sql("DELETE FROM points WHERE key = 0; DELETE FROM keyframe WHERE key = 3");
  StoredMap stored = open();
  EXPECT_THAT(stored.part(every(1)).error().message, HasSubstr("is damaged (rows of keyframe 3"));
  std::set<KeyFrameId> others = every(1);
  std::erase_if(others, [](KeyFrameId id) { return id.slot == 3; });
  EXPECT_THAT(stored.part(others).error().message, HasSubstr("is damaged (points 0 are missing"));
}

TEST_F(StoredMapTest, WhatIsNoMapIsRefusedAsByALoad) {
  fs::remove(file_);
  EXPECT_THAT(StoredMap::open(file_).error().message, HasSubstr("there is no such file"));
}

/// The file as version 1 had it: no words, and keyframes that do not say where their points are.
void write_version_1(const fs::path& from, const fs::path& to) {
  using namespace map_format;  // NOLINT(google-build-using-namespace)
  Database source(from, Database::Mode::read);
  Database target(to, Database::Mode::create);
  target.run("PRAGMA application_id = " + std::to_string(kApplicationId));
  target.run("PRAGMA user_version = 1");
  for (const TableShape* const table : kTables1) target.create_table(*table);
  std::uint64_t digest = 0;
  for (std::size_t i = 0; i < std::size(kContent1); ++i) {
    const TableShape& to_table = *kContent1[i];
    const TableShape& from_table = i == 0 ? kKeyframe : to_table;
    source.for_each(from_table, [&](const Row& row, std::uint64_t) {
      Row copy = row;
      copy.values.resize(to_table.columns.size());
      digest += checksum_of(to_table, copy);
      target.put(to_table, copy, checksum_of(to_table, copy));
    });
  }
  Row atlas = *source.find(kAtlas, 1);
  atlas.values.back() = static_cast<std::int64_t>(digest);
  target.put(kAtlas, atlas, checksum_of(kAtlas, atlas));
}

TEST_F(StoredMapTest, AFileOfVersion1IsReadWholeAndWrittenAnewByTheFirstSave) {
  const fs::path old = temporary_.path() / "old.map";
  write_version_1(file_, old);
  EXPECT_FALSE(StoredMap::open(old).value().has_parts());
  EXPECT_TRUE(check_map(old).faults.empty());
  const Atlas loaded = load_map(old).value();
  EXPECT_EQ(dump_map(loaded), dump_map(whole_));
  MapWriter writer = MapWriter::open(old).value();
  const MapSave saved = writer.save(loaded).value();
  EXPECT_TRUE(saved.whole);
  EXPECT_TRUE(StoredMap::open(old).value().has_parts());
  EXPECT_EQ(dump_map(load_map(old).value()), dump_map(whole_));
}

TEST_F(StoredMapTest, ALoadFindsKeyframesThatLeadToOtherPoints) {
  run_sql("UPDATE keyframe SET point_blocks = X'0105' WHERE key = 2");
  EXPECT_THAT(load_map(file_).error().message, HasSubstr("table keyframe, row 2: checksum"));
  // With a checksum that is right: whoever wrote it was wrong.
  Atlas other = walked_atlas();
  const fs::path file = temporary_.path() / "wrong.map";
  ASSERT_TRUE(save_map(other, file).ok());
  {
    using namespace map_format;  // NOLINT(google-build-using-namespace)
    Database database(file, Database::Mode::write);
    Row row = *database.find(kKeyframe, 2);
    const std::uint64_t before = checksum_of(kKeyframe, row);
    row.values.back() = std::string("\x01\x00", 2);
    const std::uint64_t after = checksum_of(kKeyframe, row);
    database.put(kKeyframe, row, after);
    Row atlas = *database.find(kAtlas, 1);
    const auto digest = static_cast<std::uint64_t>(atlas.integer(13)) - before + after;
    atlas.values.back() = static_cast<std::int64_t>(digest);
    database.put(kAtlas, atlas, checksum_of(kAtlas, atlas));
  }
  EXPECT_THAT(load_map(file).error().message, HasSubstr("keyframe 2: its points lie elsewhere"));
}

}  // namespace
}  // namespace ydd
