// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/camera_path.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "ydd/simulation/closed_curve.h"
#include "ydd/simulation/random.h"
#include "ydd/simulation/room.h"

namespace ydd {
namespace {

using Eigen::Vector3d;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// What the camera of the standing paths looks at: the middle of the desks.
const Vector3d kTarget_m{2.75, 4.6, 1.12};

/// Sum of three sines of incommensurate rates, amplitude about `scale`.
class Wobble {
 public:
  Wobble(sim::Random random, double scale) : scale_(scale) {
    for (double& phase : phases_) phase = random.uniform(0.0, kTurn);
  }
  double at(double t) const {
    return scale_ * (0.55 * std::sin(kTurn * 0.37 * t + phases_[0]) +
                     0.30 * std::sin(kTurn * 0.91 * t + phases_[1]) +
                     0.15 * std::sin(kTurn * 2.3 * t + phases_[2]));
  }

 private:
  double scale_;
  std::array<double, 3> phases_{};
};

/// The hand that holds the camera: metres and radians.
class Tremor {
 public:
  Tremor(int seed, double position_m, double angle_rad) {
    const sim::Random random(sim::mix_bits(static_cast<std::uint64_t>(seed), 4711));
    for (std::uint64_t i = 0; i < 6; ++i) {
      wobbles_.emplace_back(random.fork(i), i < 3 ? position_m : angle_rad);
    }
  }
  SE3 at(double t) const {
    const auto three = [&](std::size_t first) {
      return Vector3d(wobbles_[first].at(t), wobbles_[first + 1].at(t), wobbles_[first + 2].at(t));
    };
    return {so3_exp(three(3)), three(0)};
  }

 private:
  std::vector<Wobble> wobbles_;
};

double degrees(double value) { return value * kTurn / 360.0; }

TimedPath static_path(const Tremor& tremor) {
  const SE3 T = look_at(kCameraPlace_m, kTarget_m);
  return {[=](double t) { return T * tremor.at(t); }, 8.0};
}

TimedPath xyz_path(const Tremor& tremor) {
  const SE3 T = look_at(kCameraPlace_m, kTarget_m);
  return {[=](double t) {
            const Vector3d offset(0.30 * std::sin(kTurn * t / 4.6),
                                  0.20 * std::sin(kTurn * t / 3.7 + 1.0) - 0.168,
                                  0.16 * std::sin(kTurn * t / 6.1));
            const SE3 swing(T.rotation(),
                            T.translation() + Vector3d(offset.x(), offset.z(), offset.y()));
            return swing * tremor.at(t);
          },
          10.0};
}

TimedPath rpy_path(const Tremor& tremor) {
  const SE3 T = look_at(kCameraPlace_m, kTarget_m);
  return {[=](double t) {
            const Vector3d angles(degrees(11) * std::sin(kTurn * t / 4.1),
                                  degrees(18) * std::sin(kTurn * t / 5.3),
                                  degrees(16) * std::sin(kTurn * t / 3.3));
            return T * SE3(so3_exp(angles), Vector3d::Zero()) * tremor.at(t);
          },
          10.0};
}

TimedPath halfsphere_path(const Tremor& tremor) {
  return {[=](double t) {
            const double azimuth = degrees(26) * std::sin(kTurn * t / 7.3);
            const double elevation = degrees(14) - degrees(9) * std::cos(kTurn * t / 4.7);
            const double radius = 3.05;
            const Vector3d out(std::sin(azimuth) * std::cos(elevation),
                               -std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
            return look_at(kTarget_m + radius * out, kTarget_m) * tremor.at(t);
          },
          14.0};
}

/// Once round the room, or through all rooms and back.
std::vector<Eigen::Vector2d> walk(int rooms) {
  std::vector<Eigen::Vector2d> p;
  const double door = sim::kDoorMiddle_m;
  if (rooms == 1) {
    for (int i = 0; i < 12; ++i) {
      const double angle = kTurn * (0.5 - i / 12.0);
      p.emplace_back(3.0 + 2.05 * std::cos(angle), 2.2 + 1.3 * std::sin(angle));
    }
    return p;
  }
  const auto pass = [&](double x, double sign) {
    for (const double d : {-0.8, 0.0, 0.8}) p.emplace_back(x + sign * d, door);
  };
  for (int room = 0; room < rooms; ++room) {  // there, along the near side
    const double x0 = room * sim::kRoomPitch_m;
    for (const double x : {1.6, 3.0, 4.3}) p.emplace_back(x0 + x, 1.35);
    if (room + 1 < rooms) pass(x0 + 0.5 * (sim::kRoomWidth_m + sim::kRoomPitch_m), 1.0);
  }
  for (int room = rooms - 1; room >= 0; --room) {  // and back, along the desks
    const double x0 = room * sim::kRoomPitch_m;
    for (const double x : {4.5, 3.0, 1.5}) p.emplace_back(x0 + x, 3.15);
    if (room > 0) pass(x0 - 0.5 * (sim::kRoomPitch_m - sim::kRoomWidth_m), -1.0);
  }
  return p;
}

TimedPath loop_path(const Tremor& tremor, int rooms) {
  const auto curve = std::make_shared<const sim::ClosedCurve>(walk(rooms));
  constexpr double kSpeed = 0.6;  // m/s
  constexpr double kBeyond = 1.06;
  const double inward = rooms == 1 ? degrees(12) : 0.0;
  const CameraPath path = [=](double t) {
    const double s = kSpeed * t;
    const Eigen::Vector2d here = curve->at(s);
    const Eigen::Vector2d ahead = curve->at(s + 0.5) - curve->at(s - 0.5);
    const double heading = std::atan2(ahead.y(), ahead.x()) - inward;
    const double step = kTurn * s / 1.4;  // the gait of who carries the camera
    const Vector3d eye(here.x(), here.y(), 1.42 + 0.012 * std::cos(step));
    const Vector3d target = eye + Vector3d(std::cos(heading), std::sin(heading), -0.16);
    return look_at(eye, target, degrees(0.6) * std::sin(0.5 * step)) * tremor.at(t);
  };
  return {path, kBeyond * curve->length_m() / kSpeed};
}

}  // namespace

SE3 look_at(const Vector3d& eye, const Vector3d& target, double roll_rad) {
  const Vector3d forward = (target - eye).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d rotation;
  rotation << right, forward.cross(right), forward;
  const Eigen::Quaterniond roll(Eigen::AngleAxisd(roll_rad, Vector3d::UnitZ()));
  return {Eigen::Quaterniond(rotation) * roll, eye};
}

TimedPath make_camera_path(const WorldOptions& options) {
  const Tremor still(options.seed, 0.004, degrees(0.35));
  const Tremor walking(options.seed, 0.008, degrees(0.8));
  if (options.path == PathKind::stationary) return static_path(still);
  if (options.path == PathKind::rpy) return rpy_path(walking);
  if (options.path == PathKind::halfsphere) return halfsphere_path(walking);
  if (options.path == PathKind::room_loop) return loop_path(walking, options.rooms);
  return xyz_path(walking);
}

}  // namespace ydd
