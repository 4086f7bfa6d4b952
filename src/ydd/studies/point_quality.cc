// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/point_quality.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ydd {
namespace {

/// What the edge rule calls a silhouette.
constexpr int kSilhouette_px = 3;

/// Whether a pixel of the mask moves in the square of that half side round a point.
bool moves_within(const Image<std::uint8_t>& moving, const Keypoint& keypoint, int half_side_px) {
  const auto cx = static_cast<int>(std::lround(keypoint.x_px));
  const auto cy = static_cast<int>(std::lround(keypoint.y_px));
  for (int y = cy - half_side_px; y <= cy + half_side_px; ++y) {
    for (int x = cx - half_side_px; x <= cx + half_side_px; ++x) {
      if (moving.contains(x, y) && moving(x, y) > 0) return true;
    }
  }
  return false;
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
  in_person += other.in_person;
  in_person_kept += other.in_person_kept;
  inner += other.inner;
  inner_kept += other.inner_kept;
  return *this;
}

double PointQuality::recall() const { return share(moving_rejected, moving); }
double PointQuality::precision() const { return share(moving_rejected, rejected()); }
double PointQuality::kept_in_persons() const { return share(in_person_kept, in_person); }
double PointQuality::kept_off_silhouettes() const { return share(inner_kept, inner); }

PointQuality point_quality(const std::vector<Rule>& rules, const std::vector<Keypoint>& keypoints,
                           const Image<std::uint8_t>& moving, const std::vector<Box>& persons) {
  if (rules.size() != keypoints.size()) {
    throw std::logic_error("point_quality: one rule for each keypoint is needed");
  }
  PointQuality quality;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const int kept = rules[i] == Rule::kept ? 1 : 0;
    if (moves_within(moving, keypoints[i], 0)) {
      ++quality.moving;
      quality.moving_rejected += 1 - kept;
      continue;
    }
    ++quality.stationary;
    quality.stationary_rejected += 1 - kept;
    const bool in_person = std::any_of(persons.begin(), persons.end(), [&](const Box& box) {
      return box.contains(keypoints[i].x_px, keypoints[i].y_px);
    });
    if (!in_person) continue;
    ++quality.in_person;
    quality.in_person_kept += kept;
    if (moves_within(moving, keypoints[i], kSilhouette_px)) continue;
    ++quality.inner;
    quality.inner_kept += kept;
  }
  return quality;
}

}  // namespace ydd
