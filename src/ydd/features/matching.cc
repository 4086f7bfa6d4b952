// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/matching.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace ydd {
namespace {

constexpr std::size_t kRotationBins = 30;
constexpr std::size_t kRotationBinsKept = 3;

// Cells are clamped to the image and not rejected: undistortion moves some keypoints outside it,
// and a clamp (monotone) applied to points and queries alike loses none of them.
int cell_of(float offset_px, float cell_px, int count) {
  const float cell = std::floor(offset_px / cell_px);
  return static_cast<int>(std::clamp(cell, 0.0F, static_cast<float>(count - 1)));
}

int cells_along(int size_px, float cell_px) {
  return std::max(1, static_cast<int>(std::ceil(static_cast<float>(size_px) / cell_px)));
}

// Bin 0 is centred on no rotation, the common case, so that noise does not split it.
std::size_t rotation_bin(float difference_rad) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  const double turns = difference_rad / kTurn_rad;
  const double fraction = turns - std::floor(turns);
  return static_cast<std::size_t>(std::floor(fraction * kRotationBins + 0.5)) % kRotationBins;
}

std::array<bool, kRotationBins> fullest_bins(const std::array<int, kRotationBins>& counts) {
  std::array<std::size_t, kRotationBins> order{};
  for (std::size_t i = 0; i < kRotationBins; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
  std::array<bool, kRotationBins> keep{};
  for (std::size_t i = 0; i < kRotationBinsKept; ++i) {
    keep[order[i]] = counts[order[i]] * 10 >= counts[order[0]];
  }
  return keep;
}

}  // namespace

KeypointGrid::KeypointGrid(const Features& features, const Camera& camera)
    : columns_(cells_along(camera.width_px, kCell_px)),
      rows_(cells_along(camera.height_px, kCell_px)) {
  const std::size_t n = features.undistorted_px.size();
  const auto cell = [&](std::size_t i) {
    const Eigen::Vector2f& px = features.undistorted_px[i];
    const int number = cell_of(px.y() - origin_y_px_, kCell_px, rows_) * columns_ +
                       cell_of(px.x() - origin_x_px_, kCell_px, columns_);
    return static_cast<std::size_t>(number);
  };
  // Counting sort; filling from the back keeps indices increasing within a cell.
  start_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  entries_.resize(n);
  for (std::size_t i = 0; i < n; ++i) ++start_[cell(i)];
  int sum = 0;
  for (int& s : start_) s = sum += s;
  for (std::size_t i = n; i-- > 0;) {
    const Eigen::Vector2f& px = features.undistorted_px[i];
    entries_[static_cast<std::size_t>(--start_[cell(i)])] = {
        px.x(), px.y(), static_cast<std::uint32_t>(i) & 0xFFFFFFU,
        static_cast<std::uint8_t>(features.keypoints[i].octave)};
  }
}

void KeypointGrid::query(float x_px, float y_px, float radius_px, int min_octave, int max_octave,
                         std::vector<int>& out) const {
  out.clear();
  if (entries_.empty()) return;
  const int first_column = cell_of(x_px - radius_px - origin_x_px_, kCell_px, columns_);
  const int last_column = cell_of(x_px + radius_px - origin_x_px_, kCell_px, columns_);
  const int first_row = cell_of(y_px - radius_px - origin_y_px_, kCell_px, rows_);
  const int last_row = cell_of(y_px + radius_px - origin_y_px_, kCell_px, rows_);
  std::size_t found = 0;
  for (int row = first_row; row <= last_row; ++row) {
    // The cells of one row lie one after the other in entries_.
    const auto begin = static_cast<std::size_t>(start_[row * columns_ + first_column]);
    const auto end = static_cast<std::size_t>(start_[row * columns_ + last_column + 1]);
    out.resize(std::max(out.size(), found + end - begin));
    for (std::size_t k = begin; k < end; ++k) {
      // Written in any case and kept by the count alone: whether one is near is a coin's toss.
      const Entry& e = entries_[k];
      const int octave = e.octave;
      out[found] = static_cast<int>(e.index);
      const bool near =
          (std::abs(e.x_px - x_px) < radius_px) & (std::abs(e.y_px - y_px) < radius_px);
      found += near & (octave >= min_octave) & (octave <= max_octave) ? 1 : 0;
    }
  }
  out.resize(found);
}

BestMatch best_match(const Descriptor& query, const Features& features,
                     std::span<const int> candidates) {
  BestMatch best;
  for (const int i : candidates) {
    const int distance = hamming_distance(query, features.descriptors[i]);
    if (distance < best.distance) {
      best.second_distance = best.distance;
      best.second_octave = best.octave;
      best.distance = distance;
      best.octave = features.keypoints[i].octave;
      best.index = i;
    } else if (distance < best.second_distance) {
      best.second_distance = distance;
      best.second_octave = features.keypoints[i].octave;
    }
  }
  return best;
}

std::vector<bool> consistent_rotation(std::span<const float> angle_differences_rad) {
  std::array<int, kRotationBins> counts{};
  for (const float d : angle_differences_rad) ++counts[rotation_bin(d)];
  const std::array<bool, kRotationBins> keep_bin = fullest_bins(counts);
  std::vector<bool> keep(angle_differences_rad.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    keep[i] = keep_bin[rotation_bin(angle_differences_rad[i])];
  }
  return keep;
}

Descriptor median_descriptor(std::span<const Descriptor> descriptors) {
  const std::size_t n = descriptors.size();
  if (n == 0) throw std::logic_error("median_descriptor: no descriptors");
  if (n <= 2) return descriptors[0];
  std::vector<int> distances(n);
  std::size_t best = 0;
  int best_median = 257;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      distances[j] = hamming_distance(descriptors[i], descriptors[j]);
    }
    // Its own distance, 0, sorts first: the lower median of the others is element n / 2.
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      best = i;
    }
  }
  return descriptors[best];
}

}  // namespace ydd
