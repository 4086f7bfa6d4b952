// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/trajectory.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TrajectoryTest : public testing::Test {
 protected:
  TrajectoryTest()
      : file_(fs::path(testing::TempDir()) /
              (std::string("trajectory_") +
               testing::UnitTest::GetInstance()->current_test_info()->name() + ".txt")) {}
  ~TrajectoryTest() override { fs::remove(file_); }

  Result<StampedPoses> read(const std::string& text) const {
    std::ofstream(file_) << text;
    return read_tum_trajectory(file_);
  }
  std::string read_error(const std::string& text) const {
    const auto poses = read(text);
    return poses ? "no error" : poses.error().message;
  }

  fs::path file_;
};

/// A quarter turn about z.
SE3 quarter_turn() {
  return {Eigen::Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), {1.0, -2.0, 0.25}};
}

TEST_F(TrajectoryTest, ReadsWhatOthersWrite) {
  const std::string tum = "1700000000.5 1 2 3 0 0 0.6 0.8\n";
  const StampedPoses expected = read(tum).value();
  const std::string all[] = {
      "1700000000.5,1,2,3,0,0,0.6,0.8\n",
      "1700000000.5; 1; 2; 3; 0; 0; 0.6; 0.8\r\n",
      "\xEF\xBB\xBF# timestamp tx ty tz qx qy qz qw\n" + tum,
      "timestamp,tx,ty,tz,qw,qx,qy,qz\n1700000000.5,1,2,3,0.8,0,0,0.6\n",
      "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n"
      "1700000000500000000,1,2,3,0.8,0,0,0.6\n",
      "1700000000500000000,1,2,3,0.8,0,0,0.6\n",
      "1700000000500000000 1 2 3 0 0 0.6 0.8\n",
      "timestamp [us],tx,ty,tz,qx,qy,qz,qw\n1700000000500000,1,2,3,0,0,0.6,0.8\n",
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1]\n1700000000500000000,1,2,3,0.8,0,0,0.6,9\n",
  };
  const auto early = read(
      "#t [ns],x,y,z,qx,qy,qz,qw\n-500000000,1,2,3,0,0,0,1\n# t of the next\n"
      "0,1,2,3,0,0,0,1\n");
  ASSERT_TRUE(early.ok()) << early.error().message;
  EXPECT_EQ(early->front().stamp.ns, -500000000);
  for (const std::string& text : all) {
    const auto poses = read(text);
    ASSERT_TRUE(poses.ok()) << text << poses.error().message;
    ASSERT_EQ(poses->size(), 1U) << text;
    EXPECT_EQ(poses->front().stamp, expected.front().stamp) << text;
    EXPECT_TRUE(
        poses->front().T_world_camera.matrix().isApprox(expected.front().T_world_camera.matrix()))
        << text;
  }
}

TEST_F(TrajectoryTest, ReadsWhatItWritesAsEuroc) {
  const StampedPoses poses = {{{1305031102'175304001}, quarter_turn()}};
  const auto again = read(format_trajectory(poses, TrajectoryFormat::euroc));
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(again->front().stamp, poses.front().stamp);
  EXPECT_TRUE(again->front().T_world_camera.matrix().isApprox(quarter_turn().matrix(), 1e-6));
}

TEST_F(TrajectoryTest, OtherUnitsAndEncodingsAreNamed) {
  EXPECT_THAT(read_error("1700000000500 1 2 3 0 0 0 1\n"), HasSubstr("milliseconds"));
  EXPECT_THAT(read_error("1700000000500000 1 2 3 0 0 0 1\n"), HasSubstr("microseconds"));
  EXPECT_THAT(read_error(std::string("\xFF\xFE", 2) + "1"), HasSubstr("UTF-16"));
}

TEST_F(TrajectoryTest, WritesNineDecimalsInEachFormat) {
  const StampedPoses poses = {{{1305031102'175304001}, quarter_turn()}};
  EXPECT_EQ(format_trajectory(poses, TrajectoryFormat::tum),
            "1305031102.175304001 1.000000000 -2.000000000 0.250000000 "
            "0.000000000 0.000000000 0.707106781 0.707106781\n");
  EXPECT_THAT(format_trajectory(poses, TrajectoryFormat::kitti),
              testing::MatchesRegex("-?0.000000000 -1.000000000 0.000000000 1.000000000 "
                                    "1.000000000 -?0.000000000 0.000000000 -2.000000000 "
                                    "0.000000000 0.000000000 1.000000000 0.250000000\n"));
  EXPECT_EQ(format_trajectory(poses, TrajectoryFormat::euroc),
            "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n"
            "1305031102175304001,1.000000000,-2.000000000,0.250000000,"
            "0.707106781,0.000000000,0.000000000,0.707106781\n");
}

TEST_F(TrajectoryTest, WrittenThenReadIsTheSame) {
  StampedPoses poses;
  for (int i = 0; i < 50; ++i) {
    Vector6d twist;
    twist << 0.1 * i, 1.0, -0.2 * i, 0.05 * i, -0.02 * i, 0.06 * i;
    poses.push_back({{1'700'000'000'000'000'007 + i * 33'333'333LL}, SE3::exp(twist)});
  }
  ASSERT_TRUE(write_trajectory(file_, poses));
  const auto back = read_tum_trajectory(file_);
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ((*back)[i].stamp, poses[i].stamp);
    const SE3 difference = poses[i].T_world_camera.inverse() * (*back)[i].T_world_camera;
    EXPECT_LT(difference.log().norm(), 5e-9);
  }
}

TEST_F(TrajectoryTest, ReadsCommentsBlankLinesAndCarriageReturns) {
  const auto poses = read(
      "# ground truth trajectory\n\n"
      "1305031101.9758 1.3877 0.6338 1.7091 0.6648 0.5995 -0.2818 -0.3454\r\n"
      "   # in between\n"
      "1.3050311e+09 0 0 0 0 0 0 1 \n");
  EXPECT_THAT(poses.error().message, HasSubstr(":5: stamp 1.3050311e+09 is earlier than"));
  const auto good = read("#x\n\n  12.5 1 2 3 0 0 0 1\r\n\n13\t1 2 +4 0 0 0 -1\n");
  ASSERT_TRUE(good) << good.error().message;
  ASSERT_EQ(good->size(), 2U);
  EXPECT_EQ(good->back().stamp.ns, 13'000'000'000);
  EXPECT_EQ(good->back().T_world_camera.translation().z(), 4.0);
}

TEST_F(TrajectoryTest, BadLinesAreNamed) {
  const std::string good = "1.0 0 0 0 0 0 0 1\n";
  EXPECT_THAT(read_error(good + "2.0 0 0 0 0 0 1\n"),
              HasSubstr(".txt:2: expected 'timestamp tx ty tz qx qy qz qw', found '2.0 0 0"));
  EXPECT_THAT(read_error(good + "two 0 0 0 0 0 0 1\n"),
              HasSubstr(".txt:2: 'two' is not a time in seconds"));
  EXPECT_THAT(read_error(good + "2.0 0 0 x 0 0 0 1\n"), HasSubstr(".txt:2: 'x' is not a number"));
  EXPECT_THAT(read_error(good + "2.0 0 0 nan 0 0 0 1\n"), HasSubstr(":2: 'nan' is not a number"));
  EXPECT_THAT(read_error(good + "2.0 0 0 0 0 0 0 0\n"),
              HasSubstr(".txt:2: the quaternion has length 0.0000, not 1"));
  EXPECT_THAT(read_error(good + good), HasSubstr(".txt:2: duplicate stamp 1.0"));
  EXPECT_THAT(read_error("# nothing\n"), HasSubstr(".txt: holds no pose"));
  EXPECT_THAT(read_tum_trajectory("/nonexistent/t.txt").error().message,
              HasSubstr("/nonexistent/t.txt: cannot be opened"));
}

TEST_F(TrajectoryTest, FormatNames) {
  EXPECT_EQ(parse_trajectory_format("tum"), TrajectoryFormat::tum);
  EXPECT_EQ(parse_trajectory_format("kitti"), TrajectoryFormat::kitti);
  EXPECT_EQ(parse_trajectory_format("euroc"), TrajectoryFormat::euroc);
  EXPECT_EQ(parse_trajectory_format("TUM"), std::nullopt);
}

}  // namespace
}  // namespace ydd
