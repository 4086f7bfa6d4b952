// SPDX-License-Identifier: Apache-2.0
//
// A sensor that lies for two seconds: the rest of the trajectory stays, the state tells that it
// coasts, and nothing of the stretch enters the map. On a simulated room always, on the rendered
// crowd where YDD_DATA names the folder that holds crowd_xyz.
#include <cmath>
#include <cstdlib>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "altered_sequence.h"
#include "small_world.h"
#include "ydd/evaluation/ate.h"
#include "ydd/image/decode.h"
#include "ydd/image/encode.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;

enum class Fault { constant, noise, frozen, late, turned };

struct Stretch {
  std::size_t first = 0, last = 0;  ///< frames
  bool holds(std::size_t i) const { return i >= first && i <= last; }
};

constexpr int kLateFrames = 5;

void write_depth(const fs::path& file, const RawDepthImage& like, Fault fault, unsigned seed) {
  std::vector<std::uint16_t> counts(
      static_cast<std::size_t>(like.width()) * static_cast<std::size_t>(like.height()), 10000);
  std::mt19937 random(seed);
  if (fault == Fault::noise) {
    for (std::uint16_t& c : counts) c = static_cast<std::uint16_t>(2500 + random() % 25000U);
  }
  const Result<void> written =
      write_png(file, RawDepthImage(like.width(), like.height(), std::move(counts)));
  ASSERT_TRUE(written.ok()) << written.error().message;
}

void write_turned(const fs::path& file, const ColourImage& upright) {
  const std::size_t n =
      static_cast<std::size_t>(upright.width()) * static_cast<std::size_t>(upright.height());
  std::vector<Bgr> pixels(upright.data(), upright.data() + n);
  std::reverse(pixels.begin(), pixels.end());
  const Result<void> written =
      write_png(file, ColourImage(upright.width(), upright.height(), std::move(pixels)));
  ASSERT_TRUE(written.ok()) << written.error().message;
}

/// The sequence again, with a fault in the stretch: lists that name other files.
void make_faulty(const fs::path& from, const fs::path& to, Fault fault, const Stretch& stretch) {
  const Result<Sequence> sequence = open_sequence(from);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  make_altered(from, to, [&](std::size_t i, SequenceEntry& entry) {
    if (!stretch.holds(i)) return;
    const fs::path made = to / fmt::format("{}.png", i);
    if (fault == Fault::frozen) {
      entry.depth_name = sequence->entry(stretch.first).depth_name;
    } else if (fault == Fault::late) {
      entry.depth_name = sequence->entry(i - kLateFrames).depth_name;
    } else if (fault == Fault::turned) {
      write_turned(made, load_colour(entry.colour_name).value());
      entry.colour_name = made;
    } else {
      write_depth(made, load_raw_depth(entry.depth_name).value(), fault, static_cast<unsigned>(i));
      entry.depth_name = made;
    }
  });
}

/// ATE in metres of the frames outside of the stretch.
double ate_outside_m(const fs::path& sequence, const fs::path& out, const json& frames,
                     const Stretch& stretch) {
  const auto truth = read_tum_trajectory(sequence / "groundtruth.txt");
  const auto all = read_tum_trajectory(out / "trajectory.tum");
  if (!truth || !all) return HUGE_VAL;
  StampedPoses outside;
  const double first_s = frames.at("stamp_s").at(stretch.first);
  const double last_s = frames.at("stamp_s").at(stretch.last);
  for (const StampedPose& pose : *all) {
    if (pose.stamp.seconds() < first_s || pose.stamp.seconds() > last_s) outside.push_back(pose);
  }
  const auto ate = absolute_trajectory_error(*truth, outside);
  return ate ? ate->statistics_m.rmse : HUGE_VAL;
}

struct Case {
  Fault fault;
  const char* name;
  int frames;    ///< how long it lasts, at 30 in a second
  int coasting;  ///< at least so many of them
};

class LyingSensor : public testing::TestWithParam<Case> {
 protected:
  /// Runs the sequence with the fault from `first` on and judges what came of it.
  static void expect_harmless(const fs::path& sequence, std::size_t first,
                              std::vector<std::string> options, double allowed_m) {
    const TemporaryFolder folder;
    const Stretch stretch{first, first + static_cast<std::size_t>(GetParam().frames) - 1};
    make_faulty(sequence, folder / "faulty", GetParam().fault, stretch);
    if (HasFatalFailure()) return;
    options.insert(options.begin(),
                   {"run", folder / "faulty", "--out", folder / "o", "--quiet", "--deterministic"});
    const Outcome outcome = ydd_slam(options);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const json frames = json::parse(read_file(folder / "o/frames.json").value());
    const double error_m = ate_outside_m(sequence, folder / "o", frames, stretch);
    RecordProperty("ate_um", static_cast<int>(1e6 * error_m));
    EXPECT_LT(error_m, allowed_m) << outcome.err;
    int coasting = 0;
    int keyframes = 0;
    for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
      if (frames.at("state").at(i) == "coasting") ++coasting;
      if (frames.at("keyframe").at(i) == true) ++keyframes;
    }
    RecordProperty("coasting", coasting);
    // Depth that is late is wrong only while the camera moves: it is doubted where it does harm.
    if (GetParam().fault == Fault::late) return;
    EXPECT_GE(coasting, GetParam().coasting) << outcome.err;
    EXPECT_LE(keyframes, 1) << "of the stretch: what is not yet off may enter";
    const json summary = json::parse(read_file(folder / "o/summary.json").value());
    EXPECT_FALSE(summary.at("frames_coasting").empty());
  }
};

TEST_P(LyingSensor, InASimulatedRoom) {
  if (kSanitized) GTEST_SKIP() << "too few frames";
  const fs::path sequence = small_world("walk", {"--frames", "150", "--depth", "kinect"});
  expect_harmless(sequence, 60, {}, 0.015);
}

TEST_P(LyingSensor, InARenderedCrowd) {
  const char* const data = std::getenv("YDD_DATA");  // NOLINT(concurrency-mt-unsafe)
  if (kSanitized || !data || !fs::exists(fs::path(data) / "crowd_xyz/rgb.txt")) {
    GTEST_SKIP() << "needs YDD_DATA/crowd_xyz";
  }
  const fs::path sequence = fs::path(data) / "crowd_xyz";
  expect_harmless(sequence, 150,
                  {"--camera", "tum_fr3", "--detections", sequence / "detections_gt.jsonl"}, 0.010);
}

INSTANTIATE_TEST_SUITE_P(Faults, LyingSensor,
                         testing::Values(Case{Fault::constant, "DepthConstant", 60, 31},
                                         Case{Fault::noise, "DepthNoise", 60, 31},
                                         Case{Fault::frozen, "DepthFrozen", 60, 31},
                                         // Wrong only while the camera moves.
                                         Case{Fault::late, "DepthLate", 60, 0},
                                         // Soon it is lost: nothing in the picture is known.
                                         Case{Fault::turned, "ColourTurned", 30, 10}),
                         [](const auto& tried) { return tried.param.name; });

}  // namespace
}  // namespace ydd::e2e
