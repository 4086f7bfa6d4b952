// SPDX-License-Identifier: Apache-2.0
#include <sqlite3.h>

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/map/world_testing.h"
#include "ydd/map_files/map_file.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using namespace testing_world;  // NOLINT(google-build-using-namespace)
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CheckMap : public testing::Test {
 protected:
  CheckMap() {
    const PointWorld world = make_world(150, 3);
    std::vector<View> views;
    for (int i = 0; i < 4; ++i) views.push_back(look(world, hand_held(0.2 * i)));
    const BuiltMap built = build_map(world, views);
    points_ = built.atlas.points().size();
    EXPECT_TRUE(save_map(built.atlas, file_).ok());
  }

  void change(const std::string& sql) {
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &connection), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(connection);
    sqlite3_close(connection);
  }
  std::vector<std::string> faults() const {
    const std::string before = read_file(file_).value();
    std::vector<std::string> faults = check_map(file_).faults;
    EXPECT_EQ(read_file(file_).value(), before) << "repaired in silence";
    EXPECT_EQ(faults.empty(), load_map(file_).ok());
    for (const std::string& fault : faults) EXPECT_EQ(fault.find('\n'), std::string::npos);
    return faults;
  }

  TemporaryFolder temporary_;
  fs::path file_ = temporary_.path() / "a.map";
  std::size_t points_ = 0;
};

TEST_F(CheckMap, ASoundOneIsCounted) {
  EXPECT_THAT(faults(), IsEmpty());
  const MapCheck check = check_map(file_);
  EXPECT_EQ(check.keyframes, 4U);
  EXPECT_EQ(check.points, points_);
  EXPECT_EQ(check.maps, 1U);
}

TEST_F(CheckMap, EveryWrongRowIsNamed) {
  change(
      "UPDATE keyframe SET stamp_ns = stamp_ns + 1 WHERE key IN (1, 3);"
      "UPDATE features SET checksum = 0 WHERE key = 2");
  EXPECT_THAT(faults(), ElementsAre("table keyframe, row 1: checksum does not match",
                                    "table keyframe, row 3: checksum does not match",
                                    "table features, row 2: checksum does not match"));
}

TEST_F(CheckMap, AMissingRowIsNoticed) {
  change("DELETE FROM points WHERE key = 0");
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("rows of it are missing")));
}

TEST_F(CheckMap, ARowThatSaysWhatIsInsideMayBeMissingToo) {
  change("DELETE FROM atlas");
  EXPECT_FALSE(faults().empty());
}

TEST_F(CheckMap, DamagedPagesAreFaultsAndNoEnd) {
  std::string bytes = read_file(file_).value();
  for (std::size_t at = 4096 * 3; at < 4096 * 4; ++at) bytes[at] = static_cast<char>(at * 7);
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_FALSE(faults().empty());
}

TEST_F(CheckMap, WhatIsNoMapIsOneFault) {
  std::ofstream(file_, std::ios::binary) << std::string(5000, 'x');
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("is not a map file of ydd-slam")));
  fs::remove(file_);
  EXPECT_EQ(check_map(file_).faults.size(), 1U);
}

}  // namespace
}  // namespace ydd
