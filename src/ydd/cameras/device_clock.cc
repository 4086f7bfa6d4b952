// SPDX-License-Identifier: Apache-2.0
#include "ydd/cameras/device_clock.h"

#include <cstdlib>

namespace ydd {
namespace {

/// No picture is so late on its way, and no clock of a camera so wrong between two pictures.
constexpr std::int64_t kJump_ns = 1'000'000'000;
constexpr std::int64_t kLeastStep_ns = 1'000;  // microseconds are what devices count in

}  // namespace

Timestamp DeviceClock::to_host(Timestamp device, Timestamp arrived) {
  bool anew = !before_;
  if (before_) {
    const std::int64_t step_ns = device.ns - before_->device.ns;
    anew = step_ns <= 0 || std::abs(step_ns - (arrived.ns - before_->arrived.ns)) > kJump_ns;
  }
  if (anew) offset_ns_ = arrived.ns - device.ns;
  before_ = {device, arrived};
  Timestamp host{device.ns + offset_ns_};
  if (newest_ && host.ns <= newest_->ns) host.ns = newest_->ns + kLeastStep_ns;
  newest_ = host;
  return host;
}

}  // namespace ydd
