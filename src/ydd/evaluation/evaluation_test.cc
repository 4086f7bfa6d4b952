// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "ydd/base/files.h"
#include "ydd/evaluation/report.h"

namespace ydd {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kPeriod_ns = 100'000'000;

/// A winding path, ten poses a second.
StampedPoses path(int poses) {
  StampedPoses result;
  for (int i = 0; i < poses; ++i) {
    Vector6d twist;
    twist << std::sin(0.1 * i), 0.05 * i, std::cos(0.13 * i), 0.02 * i, 0.01 * i, -0.015 * i;
    result.push_back({{kStart_ns + i * kPeriod_ns}, SE3::exp(twist)});
  }
  return result;
}

/// The same camera motion, told in another world frame.
StampedPoses moved(StampedPoses poses, const SE3& T_new_old, double scale = 1.0) {
  for (StampedPose& pose : poses) {
    const SE3 T = T_new_old * pose.T_world_camera;
    pose.T_world_camera = SE3(T.rotation(), scale * T.translation());
  }
  return poses;
}

SE3 some_motion() {
  Vector6d twist;
  twist << 3.0, -1.0, 2.0, 0.4, -0.8, 1.2;
  return SE3::exp(twist);
}

TEST(ErrorStatistics, OfFourNumbers) {
  const std::vector<double> errors = {4.0, 1.0, 2.0, 3.0};
  const ErrorStatistics s = error_statistics(errors);
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.sd, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.max, 4.0);
  EXPECT_DOUBLE_EQ(error_statistics(std::vector<double>{5.0, 1.0, 2.0}).median, 2.0);
  EXPECT_EQ(error_statistics({}).count, 0U);
}

TEST(Ate, WorldFrameDoesNotMatter) {
  const StampedPoses truth = path(60);
  const auto ate = absolute_trajectory_error(truth, moved(truth, some_motion()));
  ASSERT_TRUE(ate) << ate.error().message;
  EXPECT_EQ(ate->pairs.size(), 60U);
  EXPECT_LT(ate->statistics_m.max, 1e-9);
  EXPECT_LT((ate->alignment.T_target_source * some_motion()).log().norm(), 1e-9);
}

TEST(Ate, ScaleIsFoundOnlyWhenAskedFor) {
  const StampedPoses truth = path(60);
  const StampedPoses estimate = moved(truth, some_motion(), 0.5);
  EXPECT_GT(absolute_trajectory_error(truth, estimate)->statistics_m.rmse, 0.1);
  const auto ate = absolute_trajectory_error(truth, estimate, {.scale = AlignmentScale::estimated});
  EXPECT_NEAR(ate->alignment.scale, 2.0, 1e-9);
  EXPECT_LT(ate->statistics_m.max, 1e-9);
}

TEST(Ate, ErrorsAreDistances) {
  // Displacements +-e of opposite pairs of points leave the best alignment at the identity.
  StampedPoses truth;
  StampedPoses estimate;
  const std::vector<Eigen::Vector3d> corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Timestamp stamp{kStart_ns + static_cast<std::int64_t>(i) * kPeriod_ns};
    truth.push_back({stamp, {Eigen::Quaterniond::Identity(), corners[i]}});
    const Eigen::Vector3d error(0, 0, i < 2 ? 0.03 : -0.03);
    estimate.push_back({stamp, {Eigen::Quaterniond::Identity(), corners[i] + error}});
  }
  const auto ate = absolute_trajectory_error(truth, estimate);
  EXPECT_NEAR(ate->statistics_m.rmse, 0.03, 1e-12);
  EXPECT_NEAR(ate->statistics_m.sd, 0.0, 1e-12);
}

TEST(Ate, FewerThanThreePairsIsAnError) {
  const StampedPoses truth = path(60);
  StampedPoses late = truth;
  for (StampedPose& pose : late) pose.stamp.ns += 58 * kPeriod_ns;
  EXPECT_THAT(absolute_trajectory_error(truth, late).error().message,
              HasSubstr("only 2 of 60 poses have ground truth within 0.02 s"));
  EXPECT_THAT(absolute_trajectory_error(truth, {}).error().message, HasSubstr("empty"));
}

TEST(Rpe, WorldFrameDoesNotMatter) {
  const StampedPoses truth = path(60);
  const RpeResult rpe = relative_pose_error(truth, moved(truth, some_motion()));
  // Poses 0 to 48 have a partner one second later that is not the last pose.
  EXPECT_EQ(rpe.translation_m.count, 49U);
  EXPECT_LT(rpe.translation_m.max, 1e-9);
  EXPECT_LT(rpe.rotation_deg.max, 1e-6);
}

TEST(Rpe, ConstantDriftIsSeenPerSecondAndPerFrame) {
  StampedPoses truth;
  StampedPoses estimate;
  const double turn_rad = 0.2 / 180.0 * std::numbers::pi;
  for (int i = 0; i < 40; ++i) {
    const Timestamp stamp{kStart_ns + i * kPeriod_ns};
    truth.push_back({stamp, SE3()});
    Vector6d twist;
    twist << 0, 0, 0.001 * i, 0, 0, turn_rad * i;  // a screw: both parts grow evenly
    estimate.push_back({stamp, SE3::exp(twist)});
  }
  const RpeResult second = relative_pose_error(truth, estimate);
  EXPECT_NEAR(second.translation_m.mean, 0.01, 1e-9);
  EXPECT_NEAR(second.rotation_deg.max, 2.0, 1e-9);
  const RpeResult frame =
      relative_pose_error(truth, estimate, {.delta = 1.0, .unit = RpeUnit::frames});
  EXPECT_EQ(frame.translation_m.count, 38U);
  EXPECT_NEAR(frame.translation_m.rmse, 0.001, 1e-9);
  EXPECT_NEAR(frame.rotation_deg.median, 0.2, 1e-9);
}

TEST(Rpe, PosesFarFromGroundTruthAreLeftOut) {
  const StampedPoses estimate = path(60);
  StampedPoses truth = estimate;
  truth.erase(truth.begin() + 20, truth.begin() + 30);  // spacing 0.1 s: 0.2 s is near enough
  // Without truth: poses 22 to 27; as first or second of a pair that is 12 of 49.
  const RpeOptions benchmark{.benchmark_matching = true};
  EXPECT_EQ(relative_pose_error(truth, estimate, benchmark).translation_m.count, 37U);
  // Poses 20 to 29, where a true pose has to be near in time.
  EXPECT_EQ(relative_pose_error(truth, estimate).translation_m.count, 29U);
}

TEST(Rpe, SparseTruthIsNoError) {
  const StampedPoses estimate = path(60);
  StampedPoses truth;
  for (std::size_t i = 0; i < estimate.size(); i += 5) truth.push_back(estimate[i]);
  const RpeResult exact = relative_pose_error(truth, estimate);
  EXPECT_GT(exact.translation_m.count, 5U);
  EXPECT_LT(exact.translation_m.max, 1e-9);
  const RpeResult benchmark = relative_pose_error(truth, estimate, {.benchmark_matching = true});
  EXPECT_GT(benchmark.translation_m.count, 2 * exact.translation_m.count);
  EXPECT_GT(benchmark.translation_m.max, 1e-3);  // the camera's own motion
}

TEST(Rpe, NothingWhenTooShort) {
  EXPECT_EQ(relative_pose_error(path(60), path(8)).translation_m.count, 0U);
  EXPECT_EQ(relative_pose_error({}, path(8)).translation_m.count, 0U);
  EXPECT_EQ(relative_pose_error(path(60), {}).translation_m.count, 0U);
}

TEST(Report, TableAndJson) {
  const StampedPoses truth = path(60);
  const auto evaluation = evaluate(truth, moved(truth, some_motion(), 0.5),
                                   {.ate = {.scale = AlignmentScale::estimated}, .rpe = {}});
  ASSERT_TRUE(evaluation) << evaluation.error().message;
  const std::string table = format_table(*evaluation);
  EXPECT_THAT(table, HasSubstr("60 of 60 poses with ground truth within 0.02 s; aligned by Sim(3), "
                               "scale 2.000000\n"));
  EXPECT_THAT(table, HasSubstr("RPE/1 s [deg]"));
  const json report = json::parse(format_json(*evaluation));
  EXPECT_EQ(report["ate"]["pairs"], 60);
  EXPECT_NEAR(report["ate"]["scale"].get<double>(), 2.0, 1e-9);
  EXPECT_LT(report["rpe"]["translational_error"]["rmse"].get<double>(), 1e-9);
}

TEST(Report, ShortTrajectoryHasNoRpe) {
  const auto evaluation = evaluate(path(60), path(8));
  EXPECT_THAT(format_table(*evaluation), HasSubstr("no pair that far apart"));
  EXPECT_TRUE(json::parse(format_json(*evaluation))["rpe"]["rotational_error"].is_null());
}

/// The benchmark's own figures for recorded trajectories, to the printed digits.
class BenchmarkFigures : public testing::TestWithParam<const char*> {};

void expect_printed(const json& expected, const json& actual, const std::string& what) {
  for (const auto& [key, value] : expected.items()) {
    ASSERT_TRUE(actual.contains(key)) << what << "." << key;
    const std::string name = what + "." + key;
    if (value.is_object()) {
      expect_printed(value, actual[key], name);
    } else if (value.is_number_float()) {
      EXPECT_EQ(fmt::format("{:.6f}", actual[key].get<double>()),
                fmt::format("{:.6f}", value.get<double>()))
          << name;
    } else {
      EXPECT_EQ(actual[key], value) << name;
    }
  }
}

TEST_P(BenchmarkFigures, AreReproduced) {
  const char* const data = std::getenv("YDD_DATA");
  if (!data) GTEST_SKIP() << "set YDD_DATA to the folder that holds trajectories/";
  const auto folder = std::filesystem::path(data) / "trajectories" / GetParam();
  const auto truth = read_tum_trajectory(folder / "groundtruth.txt");
  const auto estimate = read_tum_trajectory(folder / "estimate.txt");
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_TRUE(estimate) << estimate.error().message;
  const auto evaluation = evaluate(*truth, *estimate);
  ASSERT_TRUE(evaluation) << evaluation.error().message;
  const auto expected = read_file(folder / "expected.json");
  ASSERT_TRUE(expected) << expected.error().message;
  expect_printed(json::parse(*expected), json::parse(format_json(*evaluation)), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Recorded, BenchmarkFigures,
                         testing::Values("fr3_sitting_static", "fr3_walk_rpy", "fr3_walk_xyz"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace ydd
