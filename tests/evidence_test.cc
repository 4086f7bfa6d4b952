// SPDX-License-Identifier: Apache-2.0
//
// Whole runs of variant `evidence` through the binary: what stands still is kept and what moves is
// found, whatever it is called (docs/method.md, section 11).
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "accuracy.h"
#include "small_world.h"
#include "ydd/base/files.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;

std::vector<std::string> of(const std::string& variant, std::vector<std::string> more) {
  more.insert(more.end(), {"--deterministic", "--quiet", "--dynamic", variant});
  return more;
}

/// Error of a run in metres.
double ate_of(const fs::path& sequence, const fs::path& out, std::vector<std::string> options) {
  options.insert(options.begin(), {"run", sequence.string(), "--out", out.string()});
  const Outcome outcome = ydd_slam(options);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return ate_m(sequence, out);
}

fs::path world(const std::string& name, const std::vector<std::string>& options) {
  std::vector<std::string> all = {"--frames", fmt::format("{}", kFrames), "--depth", "kinect"};
  all.insert(all.end(), options.begin(), options.end());
  return small_world(name, all);
}

TEST(Evidence, FindsAMoverWithoutAClass) {
  const TemporaryFolder folder;
  const fs::path robot = world("robot", {"--mover", "robot"});
  const double measured_m = ate_of(robot, folder / "a", of("evidence", {"--detector", "none"}));
  const json summary = json::parse(read_file(folder / "a/summary.json").value());
  EXPECT_EQ(summary.at("variant"), "evidence");
  EXPECT_EQ(summary.at("frames_tracked"), kFrames);
  if (kSanitized) return;  // twelve frames show nothing
  EXPECT_GT(summary.at("features_rejected_by_rule").at("seen_moving"), 1000);
  EXPECT_LT(measured_m, 0.035);
  const double presumed_m = ate_of(robot, folder / "b", of("off", {"--detector", "none"}));
  EXPECT_LT(measured_m, 0.6 * presumed_m);
}

TEST(Evidence, KeepsPeopleLikeStatues) {
  if (kSanitized) GTEST_SKIP() << "twelve frames show nothing";
  const TemporaryFolder folder;
  const fs::path statues = world("statues", {"--busy", "--set", "frozen_at_s=1"});
  const std::vector<std::string> boxes = {"--detections", statues / "detections.jsonl"};
  const double measured_m = ate_of(statues, folder / "a", of("evidence", boxes));
  EXPECT_LT(measured_m, 0.012);
  EXPECT_LT(measured_m, 0.6 * ate_of(statues, folder / "b", of("full", boxes)));
}

TEST(Evidence, IsEqualToTheByte) {
  const TemporaryFolder folder;
  const std::vector<std::string> options = of("evidence", {"--detector", "none"});
  ate_of(busy_room(), folder / "a", options);
  ate_of(busy_room(), folder / "b", options);
  EXPECT_EQ(read_file(folder / "a/trajectory.tum").value(),
            read_file(folder / "b/trajectory.tum").value());
}

}  // namespace
}  // namespace ydd::e2e
