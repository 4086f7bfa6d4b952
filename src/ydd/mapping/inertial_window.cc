// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/inertial_window.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "ydd/reckoning/inertial_fit.h"
#include "ydd/reckoning/reckoning_options.h"

namespace ydd {
namespace {

constexpr double kLongestLink_s = 10.0;
constexpr std::size_t kLeastNodes = 5;  // and so long, for gravity and biases
constexpr double kLeastSpan_s = 1.5;
constexpr double kMostBias_m_s2 = 1.5;  // of an accelerometer that is mounted as it is said

/// How sure biases and gravity are at first, and when many bundles have taught them: they may go on
/// changing slowly.
constexpr double kGyroBias_rad_s[] = {5e-3, 5e-4};
constexpr double kAccelBias_m_s2[] = {0.1, 0.01};
constexpr double kGravity_rad[] = {0.03, 0.002};

double sigma_after(int bundles, const double (&first_last)[2]) {
  return std::max(first_last[1], first_last[0] / (1 + bundles));
}

SE3 imu_of(const Atlas& atlas, KeyFrameId id, const SE3& T_camera_imu) {
  return atlas.at(id).T_world_camera * T_camera_imu;
}

/// What bias makes the gyroscope agree with how the IMU was seen to turn.
Eigen::Vector3d gyro_bias_of(std::span<const InertialNode> nodes,
                             std::span<const InertialMeasurement> between) {
  Eigen::Matrix3d H = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < between.size(); ++k) {
    const Eigen::Quaterniond seen =
        nodes[k].T_world_imu.rotation().conjugate() * nodes[k + 1].T_world_imu.rotation();
    const Eigen::Matrix3d& D = between[k].turn_by_gyro_bias;
    H += D.transpose() * D;
    b += D.transpose() * so3_log(between[k].sum.turn.conjugate() * seen);
  }
  return between.front().gyro_bias_rad_s + H.ldlt().solve(b);
}

/// Whether gyroscope and camera tell of the same turns. They do not where the mounting is wrong, or
/// one clock is late.
bool turns_agree(std::span<const InertialNode> nodes, std::span<const Preintegrated> sums) {
  constexpr double kMost_rad = 0.03;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const Eigen::Quaterniond seen =
        nodes[k].T_world_imu.rotation().conjugate() * nodes[k + 1].T_world_imu.rotation();
    if (seen.angularDistance(sums[k].turn) > kMost_rad) return false;
  }
  return true;
}

/// The speed at which one goes from `from` to `to`.
Eigen::Vector3d speed_between(const SE3& from, const SE3& to, const Preintegrated& sum,
                              const Eigen::Vector3d& gravity_m_s2) {
  const double t = sum.duration_s;
  return (to.translation() - from.translation() - from.rotation() * sum.shift_m) / t -
         0.5 * t * gravity_m_s2;
}

}  // namespace

void InertialOptions::describe(OptionTable& t) {
  t.add("enabled", enabled,
        "an IMU takes part in local bundle adjustment, with speeds, biases and gravity estimated");
  t.add("keyframes", keyframes, {2, 100}, "keyframes", "the newest, that are linked by it");
  t.add("gyro_noise_rad_s", noise.gyro_rad_s, {1e-6, 1.0}, "rad/s",
        "white noise of the gyroscope, per square root of Hz");
  t.add("accel_noise_m_s2", noise.accel_m_s2, {1e-6, 10.0}, "m/s^2",
        "white noise of the accelerometer, per square root of Hz");
}

InertialWindow::InertialWindow(const InertialOptions& options)
    : options_(options),
      T_camera_imu_(parse_mounting(options.T_camera_imu, "reckoning.T_camera_imu").value()) {}

void InertialWindow::forget_before(const Atlas& atlas, const KeyFrame& keyframe) {
  std::erase_if(nodes_, [&](const Node& node) { return !atlas.find(node.keyframe); });
  if (nodes_.empty()) {
    learnt_.reset();
    return;
  }
  const Node& last = nodes_.back();
  if (atlas.at(last.keyframe).map != keyframe.map) {
    learnt_.reset();  // of gravity in that world; biases are the sensor's own
    nodes_.clear();
  } else if (seconds_between(last.stamp, keyframe.stamp) > kLongestLink_s) {
    nodes_.clear();
  }
}

void InertialWindow::enter(const Atlas& atlas, KeyFrameId id, std::span<const ImuSample> samples) {
  for (const ImuSample& sample : samples) {
    if (samples_.empty() || samples_.back().stamp < sample.stamp) samples_.push_back(sample);
  }
  const KeyFrame& keyframe = atlas.at(id);
  forget_before(atlas, keyframe);
  nodes_.push_back({id, keyframe.stamp, Eigen::Vector3d::Zero()});
  const auto most = static_cast<std::size_t>(options_.keyframes);
  if (nodes_.size() > most) nodes_.erase(nodes_.begin());
  const auto first = std::upper_bound(samples_.begin(), samples_.end(), nodes_.front().stamp,
                                      [](Timestamp t, const ImuSample& s) { return t < s.stamp; });
  if (first > samples_.begin() + 1) samples_.erase(samples_.begin(), first - 1);
  if (learnt_) {
    predict_speed(atlas);
  } else {
    learn_gravity(atlas);
  }
}

std::optional<InertialMeasurement> InertialWindow::measured(const Node& from,
                                                            const Node& to) const {
  return measure_inertial(samples_, from.stamp, to.stamp, gyro_bias_rad_s_, accel_bias_m_s2_,
                          options_.noise);
}

/// Of the newest node, and of the one before where that began the window.
void InertialWindow::predict_speed(const Atlas& atlas) {
  if (nodes_.size() < 2) return;
  Node &last = nodes_[nodes_.size() - 2], &newest = nodes_.back();
  const auto m = measured(last, newest);
  if (!m) return;
  const SE3 T_world_last = imu_of(atlas, last.keyframe, T_camera_imu_);
  if (nodes_.size() == 2) {
    last.speed_m_s = speed_between(T_world_last, imu_of(atlas, newest.keyframe, T_camera_imu_),
                                   m->sum, learnt_->gravity_m_s2);
  }
  newest.speed_m_s = last.speed_m_s + m->sum.duration_s * learnt_->gravity_m_s2 +
                     T_world_last.rotation() * m->sum.speed_m_s;
}

void InertialWindow::learn_gravity(const Atlas& atlas) {
  if (nodes_.size() < kLeastNodes ||
      seconds_between(nodes_.front().stamp, nodes_.back().stamp) < kLeastSpan_s) {
    return;
  }
  std::vector<InertialNode> seen;
  for (const Node& node : nodes_) {
    seen.push_back({node.stamp, imu_of(atlas, node.keyframe, T_camera_imu_)});
  }
  accel_bias_m_s2_.setZero();
  std::vector<Preintegrated> sums;
  for (int round = 0; round < 2; ++round) {
    std::vector<InertialMeasurement> between;
    for (std::size_t k = 0; k + 1 < nodes_.size(); ++k) {
      const auto m = measured(nodes_[k], nodes_[k + 1]);
      if (!m) return;
      between.push_back(*m);
    }
    gyro_bias_rad_s_ = gyro_bias_of(seen, between);
    sums.clear();
    for (const InertialMeasurement& m : between) {
      sums.push_back(m.with_biases(gyro_bias_rad_s_, accel_bias_m_s2_));
    }
  }
  const std::optional<InertialFit> fit = fit_inertial(seen, sums, {});
  if (!fit || !turns_agree(seen, sums) || fit->state.accel_bias_m_s2.norm() > kMostBias_m_s2)
    return;
  learnt_ = Learnt{fit->state.gravity_m_s2, 0};
  accel_bias_m_s2_ = fit->state.accel_bias_m_s2;
  for (std::size_t k = 0; k + 1 < nodes_.size(); ++k) {
    Preintegrated sum = sums[k];
    sum.shift_m += sum.shift_by_bias * accel_bias_m_s2_;
    nodes_[k].speed_m_s =
        speed_between(seen[k].T_world_imu, seen[k + 1].T_world_imu, sum, fit->state.gravity_m_s2);
  }
  nodes_.back().speed_m_s = fit->speed_m_s;
}

std::vector<KeyFrameId> InertialWindow::keyframes() const {
  std::vector<KeyFrameId> out;
  if (!learnt_) return out;
  for (const Node& node : nodes_) out.push_back(node.keyframe);
  return out;
}

std::optional<InertialProblem> InertialWindow::problem(const GatheredBundle& bundle) const {
  if (!learnt_) return std::nullopt;
  InertialProblem out;
  out.T_camera_imu = T_camera_imu_;
  out.start.speed_m_s.assign(bundle.keyframes.size(), Eigen::Vector3d::Zero());
  out.start.gyro_bias_rad_s = gyro_bias_rad_s_;
  out.start.accel_bias_m_s2 = accel_bias_m_s2_;
  out.start.gravity_m_s2 = learnt_->gravity_m_s2;
  out.gyro_bias_sigma_rad_s = sigma_after(learnt_->bundles, kGyroBias_rad_s);
  out.accel_bias_sigma_m_s2 = sigma_after(learnt_->bundles, kAccelBias_m_s2);
  out.gravity_sigma_rad = sigma_after(learnt_->bundles, kGravity_rad);
  const auto pose_of = [&](const Node& node) {
    const auto found = std::find(bundle.keyframes.begin(), bundle.keyframes.end(), node.keyframe);
    return found == bundle.keyframes.end() ? -1
                                           : static_cast<int>(found - bundle.keyframes.begin());
  };
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const int pose = pose_of(nodes_[k]);
    if (pose < 0) continue;
    out.start.speed_m_s[static_cast<std::size_t>(pose)] = nodes_[k].speed_m_s;
    const int before = k > 0 ? pose_of(nodes_[k - 1]) : -1;
    if (before < 0) continue;
    if (auto m = measured(nodes_[k - 1], nodes_[k])) out.links.push_back({before, pose, *m});
  }
  if (out.links.empty()) return std::nullopt;
  return out;
}

void InertialWindow::take(const GatheredBundle& bundle, const BundleResult& result) {
  if (!result.inertial || !learnt_) return;
  const InertialUnknowns& x = *result.inertial;
  gyro_bias_rad_s_ = x.gyro_bias_rad_s;
  accel_bias_m_s2_ = x.accel_bias_m_s2;
  learnt_->gravity_m_s2 = x.gravity_m_s2;
  ++learnt_->bundles;
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    for (Node& node : nodes_) {
      if (node.keyframe == bundle.keyframes[i]) node.speed_m_s = x.speed_m_s[i];
    }
  }
}

std::vector<Eigen::Quaterniond> InertialWindow::rotations(const Atlas& atlas) const {
  std::vector<Eigen::Quaterniond> out;
  for (const Node& node : nodes_) {
    const std::optional<SE3> T = atlas.T_world_keyframe(node.keyframe);
    out.push_back(T ? T->rotation() : Eigen::Quaterniond::Identity());
  }
  return out;
}

void InertialWindow::turned(const std::vector<Eigen::Quaterniond>& before, const Atlas& atlas) {
  const std::vector<Eigen::Quaterniond> now = rotations(atlas);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    nodes_[k].speed_m_s = now[k] * before[k].conjugate() * nodes_[k].speed_m_s;
  }
  if (!learnt_ || nodes_.empty()) return;
  learnt_->gravity_m_s2 = now.back() * before.back().conjugate() * learnt_->gravity_m_s2;
}

}  // namespace ydd
