// SPDX-License-Identifier: Apache-2.0
//
// What the fuzzers start from and what they have found, through the same functions, in every build.
#include <filesystem>
#include <ostream>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "targets.h"
#include "ydd/base/files.h"

namespace ydd::fuzz {
namespace {

namespace fs = std::filesystem;

struct Target {
  const char* name;
  void (*read)(std::string_view);
};

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

constexpr Target kTargets[] = {{"bag_mcap", bag_mcap},
                               {"bag_ros1", bag_ros1},
                               {"bag_sqlite", bag_sqlite},
                               {"camera", camera},
                               {"class_table", class_table},
                               {"detections", detections},
                               {"detector", detector},
                               {"http", http},
                               {"jpeg", jpeg},
                               {"json", json},
                               {"layouts", layouts},
                               {"live_text", live_text},
                               {"map_blobs", map_blobs},
                               {"map_file", map_file},
                               {"map_rows", map_rows},
                               {"objects", objects},
                               {"onnx", onnx},
                               {"options", options},
                               {"paper_run", paper_run},
                               {"png", png},
                               {"png_pixels", png_pixels},
                               {"ros_messages", ros_messages},
                               {"sens", sens},
                               {"sensor_image", sensor_image},
                               {"sequence", sequence},
                               {"trajectory", trajectory},
                               {"yaml", yaml}};

const fs::path kRoot = YDD_SOURCE_DIR "/fuzz";

class Inputs : public testing::TestWithParam<Target> {};

TEST_P(Inputs, AreReadOrRefused) {
  int tried = 0;
  for (const char* const kind : {"seeds", "found"}) {
    const fs::path folder = kRoot / kind / GetParam().name;
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      SCOPED_TRACE(entry.path().string());
      EXPECT_NO_THROW(GetParam().read(read_file(entry.path()).value()));
      ++tried;
    }
  }
  EXPECT_GT(tried, 0) << "a target without seeds";
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Inputs, testing::ValuesIn(kTargets),
                         [](const auto& tried) { return tried.param.name; });

TEST(InputFolders, BelongToTheTargets) {
  std::set<std::string> known;
  for (const Target& target : kTargets) known.insert(target.name);
  std::set<std::string> sources, folders;
  for (const auto& entry : fs::directory_iterator(kRoot / "targets")) {
    sources.insert(entry.path().stem());
  }
  for (const char* const kind : {"seeds", "found"}) {
    for (const auto& entry : fs::directory_iterator(kRoot / kind)) {
      folders.insert(entry.path().filename());
    }
  }
  EXPECT_EQ(sources, known);
  EXPECT_EQ(folders, known);
}

}  // namespace
}  // namespace ydd::fuzz
