// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/resize.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

namespace ydd {
namespace {

/// Which old pixels a new one covers along one axis, and how much of each.
struct Cover {
  int first = 0;
  std::vector<float> shares;  ///< sum to 1
};

std::vector<Cover> covers(int from, int to) {
  std::vector<Cover> out(static_cast<std::size_t>(to));
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double begin = i * step, end = std::min<double>(from, (i + 1) * step);
    Cover& cover = out[static_cast<std::size_t>(i)];
    cover.first = static_cast<int>(begin);
    for (int k = cover.first; k < from && k < end; ++k) {
      const double share = std::min(end, k + 1.0) - std::max(begin, static_cast<double>(k));
      cover.shares.push_back(static_cast<float>(share / (end - begin)));
    }
  }
  return out;
}

}  // namespace

ColourImage resized(const ColourImage& image, int width_px, int height_px) {
  if (width_px <= 0 || height_px <= 0 || image.empty()) throw std::logic_error("resized: no size");
  const std::vector<Cover> columns = covers(image.width(), width_px);
  const std::vector<Cover> rows = covers(image.height(), height_px);
  std::vector<Bgr> pixels;
  pixels.reserve(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  for (const Cover& row : rows) {
    for (const Cover& column : columns) {
      std::array<float, 3> sum{0.5F, 0.5F, 0.5F};
      for (std::size_t j = 0; j < row.shares.size(); ++j) {
        const Bgr* const from = image.row(row.first + static_cast<int>(j)) + column.first;
        for (std::size_t i = 0; i < column.shares.size(); ++i) {
          const float weight = row.shares[j] * column.shares[i];
          for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * static_cast<float>(from[i][c]);
        }
      }
      const auto byte = [](float v) { return static_cast<std::uint8_t>(std::min(v, 255.0F)); };
      pixels.push_back({byte(sum[0]), byte(sum[1]), byte(sum[2])});
    }
  }
  return {width_px, height_px, std::move(pixels)};
}

}  // namespace ydd
