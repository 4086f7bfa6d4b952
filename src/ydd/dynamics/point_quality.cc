// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/point_quality.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ydd {
namespace {

bool on_moving(const Image<std::uint8_t>& moving, const Keypoint& keypoint) {
  const auto x = static_cast<int>(std::lround(keypoint.x_px));
  const auto y = static_cast<int>(std::lround(keypoint.y_px));
  return moving.contains(x, y) && moving(x, y) > 0;
}

double share(int part, int whole) {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

PointQuality& PointQuality::operator+=(const PointQuality& other) {
  moving += other.moving;
  moving_rejected += other.moving_rejected;
  stationary += other.stationary;
  stationary_rejected += other.stationary_rejected;
  stationary_in_person += other.stationary_in_person;
  stationary_in_person_kept += other.stationary_in_person_kept;
  return *this;
}

double PointQuality::recall() const { return share(moving_rejected, moving); }
double PointQuality::precision() const { return share(moving_rejected, rejected()); }
double PointQuality::kept_in_persons() const {
  return share(stationary_in_person_kept, stationary_in_person);
}

PointQuality point_quality(const std::vector<Rule>& rules, const std::vector<Keypoint>& keypoints,
                           const Image<std::uint8_t>& moving, const std::vector<Box>& persons) {
  if (rules.size() != keypoints.size()) {
    throw std::logic_error("point_quality: one rule for each keypoint is needed");
  }
  PointQuality quality;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const bool rejected = rules[i] != Rule::kept;
    if (on_moving(moving, keypoints[i])) {
      ++quality.moving;
      quality.moving_rejected += rejected ? 1 : 0;
      continue;
    }
    ++quality.stationary;
    quality.stationary_rejected += rejected ? 1 : 0;
    const bool in_person = std::any_of(persons.begin(), persons.end(), [&](const Box& box) {
      return box.contains(keypoints[i].x_px, keypoints[i].y_px);
    });
    quality.stationary_in_person += in_person ? 1 : 0;
    quality.stationary_in_person_kept += in_person && !rejected ? 1 : 0;
  }
  return quality;
}

}  // namespace ydd
