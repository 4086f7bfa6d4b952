// SPDX-License-Identifier: Apache-2.0
#include "ydd/reckoning/dead_reckoning.h"

#include <algorithm>
#include <cmath>

namespace ydd {
namespace {

constexpr double kMemory_s = 15.0;
constexpr double kNodeEvery_s = 0.1;
constexpr std::size_t kNodes = 25;       // of a window: two and a half seconds
constexpr double kForget = 0.9;          // of what earlier windows said, with each
constexpr int kSlowest = 60;             // lessons after which the gyroscope's bias follows slowly
constexpr double kLongestHold_s = 0.25;  // between odometry readings, or past the last
constexpr double kSpeedSigma_m_s = 0.02;
constexpr double kLeast_m = 0.003, kLeast_rad = 0.002;  // of what is called seen

template <class Sample>
void append(std::deque<Sample>& samples, const Sample& sample) {
  if (!samples.empty() && sample.stamp <= samples.back().stamp) return;
  samples.push_back(sample);
  while (seconds_between(samples.front().stamp, sample.stamp) > kMemory_s) samples.pop_front();
}

/// The samples from shortly before `from` on.
std::vector<ImuSample> since(const std::deque<ImuSample>& samples, Timestamp from) {
  auto first = std::upper_bound(samples.begin(), samples.end(), from,
                                [](Timestamp t, const ImuSample& s) { return t < s.stamp; });
  if (first != samples.begin()) --first;
  return {first, samples.end()};
}

SE3 between(const SE3& a, const SE3& b, double share) {
  const SE3 T_a_b = a.inverse() * b;
  return a * SE3(so3_exp(share * so3_log(T_a_b.rotation())), share * T_a_b.translation());
}

/// Nothing on wheels goes from one place to the other in that time: the odometry began anew.
bool is_jump(const OdometryPose& from, const OdometryPose& to) {
  constexpr double kFastest_m_s = 20.0, kFastest_rad_s = 20.0, kSlack_m = 0.1, kSlack_rad = 0.2;
  const SE3 T_from_to = from.T_odom_base.inverse() * to.T_odom_base;
  const double dt_s = seconds_between(from.stamp, to.stamp);
  return T_from_to.translation().norm() > kSlack_m + kFastest_m_s * dt_s ||
         T_from_to.angle_rad() > kSlack_rad + kFastest_rad_s * dt_s;
}

}  // namespace

DeadReckoning::DeadReckoning(const ReckoningOptions& options)
    : options_(options),
      T_camera_imu_(parse_mounting(options.T_camera_imu, "reckoning.T_camera_imu").value()),
      T_camera_base_(parse_mounting(options.T_camera_base, "reckoning.T_camera_base").value()) {}

void DeadReckoning::add(const ImuSample& sample) { append(imu_, sample); }
void DeadReckoning::add(const OdometryPose& pose) {
  const bool later = !odometry_.empty() && odometry_.back().stamp < pose.stamp;
  if (later && is_jump(odometry_.back(), pose)) odometry_.clear();
  append(odometry_, pose);
}

void DeadReckoning::clear() {
  seen_.reset();
  nodes_.clear();
  new_nodes_ = 0;
  prior_ = {};
  fit_.reset();
}

void DeadReckoning::see(Timestamp stamp, const std::optional<SE3>& T_camera_last) {
  fit_.reset();
  if (!seen_ || !T_camera_last) {
    // What is known of gravity is of another world now; biases are the sensor's own.
    nodes_.clear();
    new_nodes_ = 0;
    prior_ = {};
    T_world_camera_ = SE3();
  } else {
    T_world_camera_ = T_world_camera_ * T_camera_last->inverse();
  }
  seen_ = stamp;
  if (!imu_.empty()) add_node(stamp);
}

void DeadReckoning::add_node(Timestamp stamp) {
  if (!nodes_.empty() && seconds_between(nodes_.back().stamp, stamp) < kNodeEvery_s) return;
  const InertialNode node{stamp, T_world_camera_ * T_camera_imu_};
  if (!nodes_.empty()) {
    const auto sum = preintegrate(since(imu_, nodes_.back().stamp), nodes_.back().stamp, stamp,
                                  gyro_bias_rad_s_, Eigen::Vector3d::Zero());
    if (sum) learn_gyro_bias(*sum, nodes_.back().T_world_imu.inverse() * node.T_world_imu);
  }
  nodes_.push_back(node);
  if (nodes_.size() > kNodes) nodes_.erase(nodes_.begin());
  if (++new_nodes_ < kNodes) return;
  new_nodes_ = 1;  // the last of one window is the first of the next
  if (const auto& fit = fit_at_last()) {
    prior_.information = kForget * prior_.information + fit->learnt.information;
    prior_.sum = kForget * prior_.sum + fit->learnt.sum;
  }
  fit_.reset();
}

void DeadReckoning::learn_gyro_bias(const Preintegrated& sum, const SE3& T_then_now) {
  const Eigen::Vector3d off_rad = so3_log(T_then_now.rotation().conjugate() * sum.turn);
  gyro_lessons_ = std::min(gyro_lessons_ + 1, kSlowest);
  gyro_bias_rad_s_ += off_rad / sum.duration_s / gyro_lessons_;
}

const std::optional<InertialFit>& DeadReckoning::fit_at_last() const {
  if (fit_) return *fit_;
  std::vector<InertialNode> nodes = nodes_;
  if (!nodes.empty() && nodes.back().stamp < *seen_) {
    nodes.push_back({*seen_, T_world_camera_ * T_camera_imu_});
  }
  std::vector<Preintegrated> sums;
  if (!nodes.empty()) {
    const std::vector<ImuSample> samples = since(imu_, nodes.front().stamp);
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      const auto sum = preintegrate(samples, nodes[k].stamp, nodes[k + 1].stamp, gyro_bias_rad_s_,
                                    Eigen::Vector3d::Zero());
      if (!sum) break;
      sums.push_back(*sum);
    }
  }
  const bool whole = !nodes.empty() && sums.size() + 1 == nodes.size();
  fit_ = whole ? fit_inertial(nodes, sums, prior_) : std::nullopt;
  return *fit_;
}

std::optional<SE3> DeadReckoning::odometry_at(Timestamp stamp) const {
  const auto after =
      std::lower_bound(odometry_.begin(), odometry_.end(), stamp,
                       [](const OdometryPose& p, Timestamp t) { return p.stamp < t; });
  if (after == odometry_.end()) {
    // The newest readings, and on as they went.
    if (odometry_.size() < 2) return std::nullopt;
    const OdometryPose &a = odometry_[odometry_.size() - 2], &b = odometry_.back();
    const double held_s = seconds_between(b.stamp, stamp);
    if (held_s > kLongestHold_s) return std::nullopt;
    return between(a.T_odom_base, b.T_odom_base, 1.0 + held_s / seconds_between(a.stamp, b.stamp));
  }
  if (after->stamp == stamp) return after->T_odom_base;
  if (after == odometry_.begin()) return std::nullopt;
  const OdometryPose& before = *(after - 1);
  const double gap_s = seconds_between(before.stamp, after->stamp);
  if (gap_s > kLongestHold_s) return std::nullopt;
  return between(before.T_odom_base, after->T_odom_base,
                 seconds_between(before.stamp, stamp) / gap_s);
}

std::optional<Eigen::Quaterniond> DeadReckoning::turned(Timestamp now) const {
  const auto sum =
      preintegrate(since(imu_, *seen_), *seen_, now, gyro_bias_rad_s_, Eigen::Vector3d::Zero());
  if (!sum) return std::nullopt;
  const Eigen::Quaterniond R_camera_imu = T_camera_imu_.rotation();
  return R_camera_imu * sum->turn.conjugate() * R_camera_imu.conjugate();
}

std::optional<ReckonedMotion> DeadReckoning::by_wheels(Timestamp now) const {
  const std::optional<SE3> then = odometry_at(*seen_), here = odometry_at(now);
  if (!then || !here) return std::nullopt;
  const double blind_s = seconds_between(*seen_, now);
  ReckonedMotion out;
  out.T_now_then = T_camera_base_ * here->inverse() * *then * T_camera_base_.inverse();
  out.has_place = blind_s <= options_.longest_s;
  out.sigma_m = kLeast_m + options_.odometry_drift_share * out.T_now_then.translation().norm();
  if (const std::optional<Eigen::Quaterniond> R_now_then = turned(now)) {
    // The gyroscope knows the turn better than the wheels, they know where it went.
    const Eigen::Vector3d place_m = out.T_now_then.inverse().translation();
    out.T_now_then = SE3(*R_now_then, -(*R_now_then * place_m));
    out.sigma_rad = kLeast_rad + options_.gyro_sigma_rad_s * blind_s;
  } else {
    out.sigma_rad = kLeast_rad + options_.odometry_drift_share * out.T_now_then.angle_rad();
  }
  return out;
}

std::optional<ReckonedMotion> DeadReckoning::by_inertia(Timestamp now) const {
  const double t_s = seconds_between(*seen_, now);
  if (t_s > options_.longest_imu_s) return std::nullopt;
  const std::optional<InertialFit>& fit = fit_at_last();
  if (!fit) return std::nullopt;
  const auto sum =
      preintegrate(since(imu_, *seen_), *seen_, now, gyro_bias_rad_s_, fit->state.accel_bias_m_s2);
  if (!sum) return std::nullopt;
  const SE3 T_world_then = T_world_camera_ * T_camera_imu_;
  const SE3 T_world_now(T_world_then.rotation() * sum->turn,
                        T_world_then.translation() + t_s * fit->speed_m_s +
                            0.5 * t_s * t_s * fit->state.gravity_m_s2 +
                            T_world_then.rotation() * sum->shift_m);
  ReckonedMotion out;
  out.T_now_then = T_camera_imu_ * T_world_now.inverse() * T_world_then * T_camera_imu_.inverse();
  out.has_place = true;
  out.sigma_m = kLeast_m + kSpeedSigma_m_s * t_s + 0.5 * options_.accel_sigma_m_s2 * t_s * t_s;
  out.sigma_rad = kLeast_rad + options_.gyro_sigma_rad_s * t_s;
  return out;
}

std::optional<ReckonedMotion> DeadReckoning::by_gyroscope(Timestamp now) const {
  const std::optional<Eigen::Quaterniond> R_now_then = turned(now);
  if (!R_now_then) return std::nullopt;
  ReckonedMotion out;
  out.T_now_then = SE3(*R_now_then, Eigen::Vector3d::Zero());
  out.sigma_rad = kLeast_rad + options_.gyro_sigma_rad_s * seconds_between(*seen_, now);
  return out;
}

std::optional<ReckonedMotion> DeadReckoning::since_seen(Timestamp now) const {
  if (!seen_ || now < *seen_) return std::nullopt;
  if (std::optional<ReckonedMotion> motion = by_wheels(now)) return motion;
  // From frame to frame a steady speed tells as much, for less work.
  if (seconds_between(*seen_, now) > kNodeEvery_s) {
    if (std::optional<ReckonedMotion> motion = by_inertia(now)) return motion;
  }
  return by_gyroscope(now);
}

}  // namespace ydd
