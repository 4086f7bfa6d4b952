// SPDX-License-Identifier: Apache-2.0
#include "ydd/cameras/live_pairing.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace ydd {
namespace {

/// Colour waits no longer for a stream of depth that stands still.
constexpr std::size_t kMostWaiting = 4;

}  // namespace

LivePairing::LivePairing(double max_difference_s)
    : most_ns_(std::llround(max_difference_s * 1e9)) {}

void LivePairing::add(LiveColour colour) { colours_.push_back(std::move(colour)); }
void LivePairing::add(LiveDepth depth) {
  depths_.push_back(std::move(depth));
  while (depths_.size() > 2 * kMostWaiting) depths_.pop_front();
}

void LivePairing::clear() {
  unpaired_ += static_cast<std::int64_t>(colours_.size());
  colours_.clear();
  depths_.clear();
}

std::optional<LivePairing::Pair> LivePairing::take() {
  while (!colours_.empty()) {
    const std::int64_t stamp_ns = colours_.front().device.ns;
    const auto difference_ns = [&](const LiveDepth& depth) {
      return std::abs(depth.device.ns - stamp_ns);
    };
    const auto nearest = std::min_element(
        depths_.begin(), depths_.end(),
        [&](const auto& a, const auto& b) { return difference_ns(a) < difference_ns(b); });
    const bool none = nearest == depths_.end();
    // Pictures of a stream are farther apart than two that belong together.
    const bool is_sure =
        !none && (depths_.back().device.ns >= stamp_ns || difference_ns(*nearest) <= most_ns_ / 2);
    if (!is_sure && colours_.size() <= kMostWaiting) return std::nullopt;
    LiveColour colour = std::move(colours_.front());
    colours_.pop_front();
    if (none || difference_ns(*nearest) > most_ns_) {
      ++unpaired_;
      continue;
    }
    LiveDepth depth = std::move(*nearest);
    depths_.erase(depths_.begin(), nearest + 1);
    return Pair{std::move(colour), std::move(depth)};
  }
  return std::nullopt;
}

}  // namespace ydd
