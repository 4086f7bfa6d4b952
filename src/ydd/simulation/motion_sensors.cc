// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/motion_sensors.h"

#include <cmath>

#include "ydd/simulation/random.h"

namespace ydd {
namespace {

using Eigen::Vector3d;
using Path = std::function<SE3(double time_s)>;  // T_world_camera

const Vector3d kGravity_m_s2{0.0, 0.0, -9.81};  // the world's z is up

// Densities and biases of sensors such as the BMI055 of depth cameras.
constexpr double kGyroNoise_rad_s = 0.0003;  // per square root of Hz
constexpr double kAccelNoise_m_s2 = 0.0015;
constexpr double kGyroBias_rad_s = 0.005;
constexpr double kAccelBias_m_s2 = 0.05;

Vector3d normal(sim::Random& random, double sigma) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return sigma * Vector3d(x, y, z);
}

/// What an ideal IMU feels on the path of its own frame. Like a real one it averages over the time
/// between two samples, so that no jerk falls between them.
ImuSample feel(const Path& T_world_camera, const SE3& T_camera_imu, double t_s, double every_s) {
  const auto at = [&](double time_s) { return T_world_camera(time_s) * T_camera_imu; };
  const SE3 now = at(t_s), before = at(t_s - every_s), after = at(t_s + every_s);
  const Vector3d accel_world =
      (after.translation() - 2.0 * now.translation() + before.translation()) / (every_s * every_s);
  const Eigen::Quaterniond turn =
      at(t_s - 0.5 * every_s).rotation().conjugate() * at(t_s + 0.5 * every_s).rotation();
  ImuSample sample;
  sample.gyro_rad_s = so3_log(turn) / every_s;
  sample.accel_m_s2 = now.rotation().conjugate() * (accel_world - kGravity_m_s2);
  return sample;
}

Timestamp stamp_at(Timestamp start, double t_s) {
  return {start.ns + 1000 * std::llround(1e6 * t_s)};
}

std::vector<ImuSample> sense_imu(const Path& path, Timestamp start, double from_s, double until_s,
                                 const MotionSensorOptions& options, sim::Random random) {
  const SE3 T_camera_imu =
      parse_mounting(simulated_mounting().T_camera_imu, "T_camera_imu").value();
  const Vector3d gyro_bias = normal(random, options.imu_noise * kGyroBias_rad_s);
  const Vector3d accel_bias = normal(random, options.imu_noise * kAccelBias_m_s2);
  const double root_hz = std::sqrt(options.imu_hz);
  std::vector<ImuSample> out;
  for (double t_s = from_s; t_s < until_s; t_s += 1.0 / options.imu_hz) {
    ImuSample sample = feel(path, T_camera_imu, t_s, 1.0 / options.imu_hz);
    sample.stamp = stamp_at(start, t_s);
    sample.gyro_rad_s += gyro_bias + normal(random, options.imu_noise * kGyroNoise_rad_s * root_hz);
    sample.accel_m_s2 +=
        accel_bias + normal(random, options.imu_noise * kAccelNoise_m_s2 * root_hz);
    out.push_back(sample);
  }
  return out;
}

/// Wheels add up each little motion with an error in proportion to it.
std::vector<OdometryPose> sense_odometry(const Path& path, Timestamp start, double from_s,
                                         double until_s, const MotionSensorOptions& options,
                                         sim::Random random) {
  const SE3 T_camera_base =
      parse_mounting(simulated_mounting().T_camera_base, "T_camera_base").value();
  const double way = 1.0 + options.odometry_slip * random.normal();
  const double turn = 1.0 + options.odometry_slip * random.normal();
  constexpr double kRough = 5.0;  // single steps slip more than the whole way
  constexpr double kFastest_m_s = 20.0;
  SE3 T_odom_base;
  SE3 T_world_last = path(from_s) * T_camera_base;
  std::vector<OdometryPose> out;
  for (double t_s = from_s; t_s < until_s; t_s += 1.0 / options.odometry_hz) {
    const SE3 T_world_base = path(t_s) * T_camera_base;
    const SE3 step = T_world_last.inverse() * T_world_base;
    const double rough = kRough * options.odometry_slip;
    // Who is carried elsewhere at once has wheels that do not turn.
    const bool carried = step.translation().norm() * options.odometry_hz > kFastest_m_s;
    if (carried) {
      T_world_last = T_world_base;
      out.push_back({stamp_at(start, t_s), T_odom_base});
      continue;
    }
    const double way_here = way + rough * random.normal();
    const double turn_here = turn + rough * random.normal();
    T_odom_base = T_odom_base *
                  SE3(so3_exp(turn_here * so3_log(step.rotation())), way_here * step.translation());
    T_world_last = T_world_base;
    out.push_back({stamp_at(start, t_s), T_odom_base});
  }
  return out;
}

}  // namespace

void MotionSensorOptions::describe(OptionTable& t) {
  t.add("imu_hz", imu_hz, {0.0, 2000.0}, "Hz", "samples of gyroscope and accelerometer; 0: none");
  t.add("imu_noise", imu_noise, {0.0, 100.0}, "",
        "noise and biases of the IMU; 1: a cheap MEMS sensor");
  t.add("odometry_hz", odometry_hz, {0.0, 1000.0}, "Hz", "readings of the wheels; 0: none");
  t.add("odometry_slip", odometry_slip, {0.0, 1.0}, "",
        "standard deviation of the wheels' error, of way and turn");
}

ReckoningOptions simulated_mounting() {
  ReckoningOptions options;
  // x forward, y left, z up (REP 103), beside the camera and below it.
  options.T_camera_imu = "0.03 0.01 -0.02 0.5 -0.5 0.5 -0.5";
  options.T_camera_base = "0 0.4 -0.1 0.5 -0.5 0.5 -0.5";
  return options;
}

MotionSamples sense_motion(const std::function<SE3(double time_s)>& T_world_camera, Timestamp start,
                           double from_s, double until_s, const MotionSensorOptions& options,
                           int seed) {
  const sim::Random random(sim::mix_bits(static_cast<std::uint64_t>(seed), 8128));
  MotionSamples out;
  if (options.imu_hz > 0) {
    out.imu = sense_imu(T_world_camera, start, from_s, until_s, options, random.fork(1));
  }
  if (options.odometry_hz > 0) {
    out.odometry = sense_odometry(T_world_camera, start, from_s, until_s, options, random.fork(2));
  }
  return out;
}

}  // namespace ydd
