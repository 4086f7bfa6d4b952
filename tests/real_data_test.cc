// SPDX-License-Identifier: Apache-2.0
//
// Recordings of the TUM RGB-D benchmark and a rendered crowd, when they are at hand: set YDD_DATA
// to the folder that holds tum_fr1_xyz, tum_fr3_walking_halfsphere and crowd_xyz, and YDD_MODELS to
// the folder with the network weights.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "command_line.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/ate.h"
#include "ydd/sources/source.h"

namespace ydd::e2e {
namespace {

/// The recording, or an empty path.
fs::path recording(const std::string& name) {
  const char* const data = std::getenv("YDD_DATA");  // NOLINT(concurrency-mt-unsafe)
  if (!data || !fs::exists(fs::path(data) / name / "rgb.txt")) return {};
  return fs::path(data) / name;
}

/// ATE in metres of a deterministic run of which more than half of the frames were tracked.
double ate_m(const fs::path& sequence, std::vector<std::string> options) {
  const TemporaryFolder folder;
  options.insert(options.begin(),
                 {"run", sequence, "--out", folder / "run", "--deterministic", "--quiet"});
  const Outcome outcome = ydd_slam(options);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto truth = read_tum_trajectory(sequence / "groundtruth.txt");
  const auto estimate = read_tum_trajectory(folder / "run/trajectory.tum");
  if (!truth || !estimate) {
    ADD_FAILURE() << "no trajectory";
    return std::nan("");  // neither above nor below anything
  }
  const std::size_t frames = open_sequence(sequence).value().size();
  EXPECT_GT(estimate->size(), frames / 2);
  const auto ate = absolute_trajectory_error(*truth, *estimate);
  if (!ate) ADD_FAILURE() << ate.error().message;
  const double rmse_m = ate ? ate->statistics_m.rmse : std::nan("");
  testing::Test::RecordProperty("ate_um", static_cast<int>(1e6 * rmse_m));
  return rmse_m;
}

TEST(RealData, StaticDesk) {
  const fs::path sequence = recording("tum_fr1_xyz");
  if (kSanitized || sequence.empty()) GTEST_SKIP() << "needs YDD_DATA/tum_fr1_xyz";
  EXPECT_LT(ate_m(sequence, {}), 0.0125);
}

TEST(RealData, CrowdWithExactBoxes) {
  const fs::path sequence = recording("crowd_xyz");
  if (kSanitized || sequence.empty()) GTEST_SKIP() << "needs YDD_DATA/crowd_xyz";
  EXPECT_LT(
      ate_m(sequence, {"--detections", sequence / "detections_gt.jsonl", "--dynamic", "full"}),
      0.010);
}

TEST(RealData, CrowdWithoutRejectionIsHopeless) {
  const fs::path sequence = recording("crowd_xyz");
  if (kSanitized || sequence.empty()) GTEST_SKIP() << "needs YDD_DATA/crowd_xyz";
  EXPECT_GT(ate_m(sequence, {"--dynamic", "off"}), 0.1);
}

TEST(RealData, WalkingPeopleSeenByTheNetworks) {
  const fs::path sequence = recording("tum_fr3_walking_halfsphere");
  const bool models = std::getenv("YDD_MODELS") != nullptr;  // NOLINT(concurrency-mt-unsafe)
  if (kSanitized || sequence.empty() || !models) {
    GTEST_SKIP() << "needs YDD_DATA/tum_fr3_walking_halfsphere and YDD_MODELS";
  }
  EXPECT_LT(
      ate_m(sequence, {"--detector", YDD_SOURCE_DIR "/configs/detector/coco_body_head_hand.yaml",
                       "--dynamic", "full"}),
      0.030);
}

}  // namespace
}  // namespace ydd::e2e
