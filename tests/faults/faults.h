// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "../small_world.h"
#include "ydd/base/json_reader.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/map_files/map_file.h"

/// What is thrown at the program, and what is then asked of what it left. `make faults` runs the
/// cases that have a chance in them more often.
namespace ydd::faults {

using namespace e2e;  // NOLINT(google-build-using-namespace)
using nlohmann::json;
using testing::HasSubstr;

/// How often a case with a random moment is tried; YDD_FAULTS=N for more.
inline int rounds(int usually) {
  const char* const wanted = std::getenv("YDD_FAULTS");  // NOLINT(concurrency-mt-unsafe)
  return kSanitized ? 1 : std::max(usually, wanted ? std::atoi(wanted) : 0);
}

/// Longer than anything here takes, also sanitized: against programs that hang.
inline constexpr int kPatience_s = kSanitized ? 280 : 90;
inline constexpr int kHung = 128 + 9;  // what `timeout -s KILL` gives

/// `sh -c SCRIPT` in `folder`. In it `ydd ...` is the binary, ended when it hangs.
inline Outcome shell(const std::string& script, const fs::path& folder) {
  const std::string head =
      fmt::format("ydd() {{ timeout -s KILL {} " YDD_BINARY " \"$@\"; }}\n", kPatience_s);
  Outcome outcome = run_program({"sh", "-c", head + script}, folder);
  EXPECT_NE(outcome.exit_code, kHung) << "hangs, or was killed";
  return outcome;
}

inline json json_of(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return {};
  const auto value = parse_json(*text, file.string());
  return value ? json(*value) : json();
}

/// Nothing half written lies about.
inline void expect_no_leftovers(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    EXPECT_FALSE(name.ends_with(".tmp") || name.ends_with(".new") || name.ends_with("-journal"))
        << entry.path();
  }
}

/// Every file that a run left in `out` is whole: it can be read, or is not there.
inline void expect_whole_files(const fs::path& out) {
  if (!fs::exists(out)) return;
  expect_no_leftovers(out);
  for (const auto& entry : fs::directory_iterator(out)) {
    const std::string file = entry.path().string();
    SCOPED_TRACE(file);
    if (file.ends_with(".json")) {
      EXPECT_TRUE(json_of(file).is_object() || json_of(file).is_array());
    } else if (file.ends_with(".tum")) {
      const auto poses = read_tum_trajectory(file);
      EXPECT_TRUE(poses.ok()) << poses.error().message;
    } else if (file.ends_with(".html")) {
      EXPECT_THAT(read_file(file).value(), HasSubstr("</html>"));
    }
  }
}

/// A map file is there and holds something.
inline void expect_good_map(const fs::path& file) {
  const auto map = load_map(file);
  ASSERT_TRUE(map.ok()) << map.error().message;
  EXPECT_GT(map->keyframes().size(), 0U);
  EXPECT_GT(map->points().size(), 0U);
  EXPECT_THAT(map->check_consistency(), testing::IsEmpty());
}

/// A failure that tells: exit 1 and one line, nothing of the machinery beneath.
inline void expect_told(const Outcome& outcome) {
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("terminate called")));
}

inline std::size_t poses_in(const fs::path& out) {
  const auto poses = read_tum_trajectory(out / "trajectory.tum");
  return poses ? poses->size() : 0;
}

}  // namespace ydd::faults
