// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/bag_motion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/messages/ros_messages.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

/// As of files: more is another unit.
constexpr double kMostOfTurning_rad_s = 100.0, kMostOfFeeling_m_s2 = 500.0;
constexpr double kMostPlace_m = 1e6;

template <std::size_t n>
bool within(const std::array<double, n>& values, double most) {
  return std::all_of(values.begin(), values.end(),
                     [&](double v) { return std::isfinite(v) && std::abs(v) <= most; });
}

Result<ImuSample> imu_sample(const ImuMessage& message) {
  if (!message.has_turn) return Error{"measures no turning (its covariance is -1)"};
  if (!message.has_acceleration) return Error{"measures no acceleration (its covariance is -1)"};
  if (!within(message.turn_rad_s, kMostOfTurning_rad_s) ||
      !within(message.acceleration_m_s2, kMostOfFeeling_m_s2)) {
    return Error{
        "has a reading that no such sensor gives (rad/s and m/s^2 are wanted); is it another "
        "unit?"};
  }
  return ImuSample{message.stamp, Eigen::Vector3d(message.turn_rad_s.data()),
                   Eigen::Vector3d(message.acceleration_m_s2.data())};
}

Result<OdometryPose> odometry_pose(const OdometryMessage& message) {
  const auto& q = message.orientation;
  const Eigen::Quaterniond turned(q[3], q[0], q[1], q[2]);
  if (!within(message.position_m, kMostPlace_m) || !within(q, 2) ||
      std::abs(turned.norm() - 1) > 0.01) {
    return Error{"has a pose that is none (its quaternion is not of length 1, or it is far away)"};
  }
  return OdometryPose{message.stamp, SE3(turned, Eigen::Vector3d(message.position_m.data()))};
}

class BagMotion : public MotionStore {
 public:
  BagMotion(std::shared_ptr<const Bag> bag, fs::path file)
      : bag_(std::move(bag)), file_(std::move(file)) {}

  std::vector<std::string> imu_topics() const override { return topics(MessageKind::imu); }
  std::vector<std::string> odometry_topics() const override {
    return topics(MessageKind::odometry);
  }
  Result<std::vector<ImuSample>> read_imu(const std::string& topic) const override {
    return samples<ImuSample>(topic, MessageKind::imu, ydd::read_imu, imu_sample);
  }
  Result<std::vector<OdometryPose>> read_odometry(const std::string& topic) const override {
    return samples<OdometryPose>(topic, MessageKind::odometry, ydd::read_odometry, odometry_pose);
  }

 private:
  std::vector<std::string> topics(MessageKind kind) const {
    std::vector<std::string> out;
    for (const BagTopic& topic : bag_->topics()) {
      if (message_kind(topic.type) == kind && topic.messages > 0) out.push_back(topic.name);
    }
    return out;
  }

  template <class Sample, class Read, class Convert>
  Result<std::vector<Sample>> samples(const std::string& topic, MessageKind kind, Read read,
                                      Convert convert) const {
    const std::string what = fmt::format("{}: {}", file_.string(), topic);
    std::vector<Sample> out;
    std::size_t damaged = 0;
    for (const BagMessage& place : bag_->messages()) {
      const BagTopic& of = bag_->topics()[place.topic];
      if (of.name != topic || message_kind(of.type) != kind) continue;
      const Result<std::string> bytes = bag_->read(place);
      if (!bytes) return bytes.error();
      const auto message = read(*bytes, of.wire);
      if (!message) {
        ++damaged;
        continue;
      }
      const auto sample = convert(*message);
      if (!sample) {
        return Error{fmt::format("{}, message {}: {}", what, out.size(), sample.error().message)};
      }
      out.push_back(*sample);
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const Sample& a, const Sample& b) { return a.stamp < b.stamp; });
    const auto repeated = std::unique(out.begin(), out.end(), [](const Sample& a, const Sample& b) {
      return a.stamp == b.stamp;
    });
    const auto left_out = damaged + static_cast<std::size_t>(out.end() - repeated);
    out.erase(repeated, out.end());
    if (left_out > 0) {
      log::warning("{}: {} messages are damaged or have the stamp of another one, and are left out",
                   what, left_out);
    }
    if (out.empty()) return Error{what + ": has no message that can be read"};
    return out;
  }

  std::shared_ptr<const Bag> bag_;
  fs::path file_;
};

}  // namespace

std::shared_ptr<const MotionStore> bag_motion(std::shared_ptr<const Bag> bag,
                                              const fs::path& file) {
  auto out = std::make_shared<const BagMotion>(std::move(bag), file);
  if (out->imu_topics().empty() && out->odometry_topics().empty()) return nullptr;
  return out;
}

}  // namespace ydd::sources
