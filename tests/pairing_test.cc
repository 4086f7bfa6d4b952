// SPDX-License-Identifier: Apache-2.0
// Depth images whose stamps are wrong: what is left out is reported, and the pictures give the
// offset.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "altered_sequence.h"
#include "small_world.h"

namespace ydd::e2e {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// The sequence with other stamps of its depth images.
template <class Stamp>
void make_restamped(const fs::path& from, const fs::path& to, Stamp stamp_of) {
  make_altered(from, to, [&](std::size_t i, SequenceEntry& entry) {
    entry.depth_stamp = stamp_of(i, entry.depth_stamp);
  });
}

constexpr int kLength = kSanitized ? 24 : 120;
fs::path walk() { return small_world("paired", {"--frames", fmt::format("{}", kLength)}); }

struct Told {
  std::string err;
  json pictures;
};

Told run(const fs::path& sequence, const fs::path& out, std::vector<std::string> options) {
  // The lists are judged whole; a few frames are enough to see that it then runs.
  options.insert(options.begin(),
                 {"run", sequence, "--detector", "none", "--max-frames", "5", "--out", out});
  const Outcome outcome = ydd_slam(options);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto summary = read_file(out / "summary.json");
  return {outcome.err, summary ? json::parse(*summary).at("pictures") : json()};
}

Timestamp later(Timestamp stamp, std::int64_t ms) { return {stamp.ns + ms * 1'000'000}; }

TEST(Pairing, ImagesWithoutPartnerAreTold) {
  const TemporaryFolder folder;
  make_restamped(walk(), folder / "s",
                 [](std::size_t i, Timestamp t) { return later(t, i < 10 ? 0 : 3'600'000); });
  const Told told = run(folder / "s", folder / "o", {});
  EXPECT_THAT(told.err,
              HasSubstr(fmt::format("only 10 of {} colour images have a depth image", kLength)));
  EXPECT_THAT(told.err,
              HasSubstr(fmt::format("--depth-offset=-3600 {} would have one", kLength - 10)));
  EXPECT_EQ(told.pictures.at("pairs"), 10);
  EXPECT_EQ(told.pictures.at("colour_images"), kLength);
}

TEST(Pairing, NothingIsWarnedOfWhenAllIsWell) {
  const TemporaryFolder folder;
  const Told told = run(walk(), folder / "o", {});
  EXPECT_THAT(told.err, Not(HasSubstr("warning")));
  EXPECT_EQ(told.pictures.at("pairs"), kLength);
}

TEST(Pairing, ThePicturesTellHowLateDepthIs) {
  if (kSanitized) GTEST_SKIP() << "too few pictures";
  const TemporaryFolder folder;
  make_restamped(walk(), folder / "s", [](std::size_t, Timestamp t) { return later(t, 50); });
  const Told told = run(folder / "s", folder / "o", {});
  EXPECT_THAT(told.err, HasSubstr("--depth-offset=-0.05 120 would have one"));
  const Told found = run(folder / "s", folder / "a", {"--depth-offset", "auto"});
  EXPECT_NEAR(found.pictures.at("depth_offset_s").get<double>(), -0.05, 0.01);
  EXPECT_THAT(found.err, Not(HasSubstr("warning")));
}

TEST(Pairing, ThePicturesOfARealCameraToo) {
  const char* const data = std::getenv("YDD_DATA");  // NOLINT(concurrency-mt-unsafe)
  if (kSanitized || !data || !fs::exists(fs::path(data) / "tum_fr1_xyz/rgb.txt")) {
    GTEST_SKIP() << "needs YDD_DATA/tum_fr1_xyz";
  }
  const TemporaryFolder folder;
  const auto offset_s = [&](int late_ms) {
    const fs::path faulty = folder / fmt::format("s{}", late_ms);
    make_restamped(fs::path(data) / "tum_fr1_xyz", faulty,
                   [&](std::size_t, Timestamp t) { return later(t, late_ms); });
    return run(faulty, folder / fmt::format("o{}", late_ms),
               {"--camera", "tum_fr1", "--depth-offset", "auto"})
        .pictures.at("depth_offset_s")
        .get<double>();
  };
  // The stamps of that camera's depth are late by themselves.
  const double own_s = offset_s(0);
  EXPECT_NEAR(own_s, -0.02, 0.01);
  EXPECT_NEAR(offset_s(-67), own_s + 0.067, 0.004);
  EXPECT_NEAR(offset_s(100), own_s - 0.1, 0.004);
}

/// Depth that lies 4 px to the right of colour, in a picture 320 px wide.
fs::path shifted_walk() {
  return small_world("shifted",
                     {"--frames", fmt::format("{}", kLength), "--set", "registration_off_px=8"});
}

TEST(DepthShift, DepthThatLiesAsideIsToldAndMovedBack) {
  const TemporaryFolder folder;
  const auto shift_of = [&](const fs::path& sequence, std::vector<std::string> options) {
    const Told told = run(sequence, folder / "o", std::move(options));
    const bool warned = told.err.find("and is moved back") != std::string::npos;
    const json summary = json::parse(read_file(folder / "o" / "summary.json").value());
    return std::pair(summary.at("depth_shift_px"), warned);
  };
  EXPECT_EQ(shift_of(shifted_walk(), {}), std::pair(json({4, 0}), true));
  EXPECT_EQ(shift_of(shifted_walk(), {"--depth-shift", "0,0"}), std::pair(json({0, 0}), false));
  EXPECT_EQ(shift_of(walk(), {}), std::pair(json({0, 0}), false));
  EXPECT_EQ(shift_of(walk(), {"--depth-shift", "-1,2"}), std::pair(json({-1, 2}), false));
}

TEST(DepthShift, OneThatIsNoneIsRefused) {
  const TemporaryFolder folder;
  const Outcome outcome =
      ydd_slam({"run", walk(), "--detector", "none", "--depth-shift", "3", "--out", folder / "o"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("--depth-shift): expected whole pixels RIGHT,DOWN"));
}

TEST(Pairing, AnOffsetThatIsNoneIsRefused) {
  const TemporaryFolder folder;
  const Outcome outcome = ydd_slam(
      {"run", walk(), "--detector", "none", "--depth-offset", "late", "--out", folder / "o"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("expected seconds (at most 1e+06) or 'auto', found 'late'"));
}

}  // namespace
}  // namespace ydd::e2e
