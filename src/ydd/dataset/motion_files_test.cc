// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/motion_files.h"

#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"

namespace ydd {
namespace {

class MotionFiles : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) {
    const std::filesystem::path path = folder_.path() / "samples.csv";
    EXPECT_TRUE(write_file_atomically(path, text));
    return path;
  }
  TemporaryFolder folder_;
};

TEST_F(MotionFiles, ReadsEurocFiles) {
  const auto samples = read_imu_file(
      file("#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
           "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
           "1403636579758555392,-0.1,0.2,-0.3,8.1,-0.4,-2.9\n"
           "1403636579763555584,-0.1,0.2,-0.3,8.0,-0.4,-2.9\n"));
  ASSERT_TRUE(samples) << samples.error().message;
  ASSERT_EQ(samples->size(), 2U);
  EXPECT_EQ(samples->front().stamp.ns, 1403636579758555392);
  EXPECT_EQ(samples->front().gyro_rad_s, Eigen::Vector3d(-0.1, 0.2, -0.3));
  EXPECT_EQ(samples->back().accel_m_s2, Eigen::Vector3d(8.0, -0.4, -2.9));
}

TEST_F(MotionFiles, GoesByTheNamesOfTheColumns) {
  const auto samples = read_imu_file(file("timestamp,ax,ay,az,gx,gy,gz\n10.5,1,2,3,0.1,0.2,0.3\n"));
  ASSERT_TRUE(samples) << samples.error().message;
  EXPECT_EQ(samples->front().accel_m_s2, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(samples->front().gyro_rad_s, Eigen::Vector3d(0.1, 0.2, 0.3));
}

TEST_F(MotionFiles, ReadsWhatItWrites) {
  const std::vector<ImuSample> samples = {{{1700000000005000000}, {1, -2, 3}, {0.5, 9.81, -1}}};
  const auto imu = read_imu_file(file(format_imu(samples)));
  ASSERT_TRUE(imu) << imu.error().message;
  EXPECT_EQ(imu->front().stamp, samples.front().stamp);
  EXPECT_EQ(imu->front().gyro_rad_s, samples.front().gyro_rad_s);
  const std::vector<OdometryPose> poses = {
      {{1700000000005000000}, SE3(so3_exp({0, 0, 1}), {1, 2, 3})}};
  const auto odometry = read_odometry_file(file(format_odometry(poses)));
  ASSERT_TRUE(odometry) << odometry.error().message;
  EXPECT_EQ(odometry->front().stamp, poses.front().stamp);
  EXPECT_LT((odometry->front().T_odom_base.translation() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-8);
}

TEST_F(MotionFiles, NamesTheLineThatIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {
      {"1 0 0 0 0 0 9.8\n2 0 0 0 0 0\n", ":2: expected"},
      {"1 0 0 0 0 0 9.8\n2 0 x 0 0 0 9.8\n", ":2: 'x' is not a number"},
      {"1 0 0 0 0 0 9.8\n1 0 0 0 0 0 9.8\n", ":2:"},
      {"1 0 0 200 0 0 9.8\n", ":1: 200 is more than any sensor of rad/s gives"},
      {"1 0 0 0 0 0 nan\n", ":1: 'nan' is not a number"},
      {"# nothing\n", "has no sample"}};
  for (const auto& [text, expected] : wrong) {
    const auto samples = read_imu_file(file(text));
    ASSERT_FALSE(samples) << text;
    EXPECT_NE(samples.error().message.find(expected), std::string::npos) << samples.error().message;
  }
  EXPECT_FALSE(read_imu_file(folder_.path() / "missing.csv"));
}

}  // namespace
}  // namespace ydd
