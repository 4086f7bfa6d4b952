// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/depth_shift.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "ydd/dataset/depth_edges.h"

namespace ydd {
namespace {

constexpr std::size_t kPairs = 16;       // that are looked at
constexpr std::size_t kFewestPairs = 6;  // of them that must tell something
constexpr int kFewestSeams = 200;        // in a picture
constexpr int kFarthestShift_px = 12;    // of a picture 640 px wide
constexpr int kLeast_px = 2;             // smaller ones are within what real sensors do
constexpr double kClearlyBetter = 1.3;   // than no shift
constexpr double kClearlyFirst = 1.15;   // than any shift that is no neighbour

enum class Axis { x, y };

/// How well edges of depth lie on steps of brightness at each shift from -farthest to farthest,
/// relative to the mean over them; empty: too few edges.
std::vector<double> agreement(const LaidPair& pair, Axis axis, int farthest) {
  const int dx = axis == Axis::x ? 1 : 0, dy = 1 - dx;
  const int width = pair.grey.width(), height = pair.grey.height();
  const int margin_x = dx * farthest, margin_y = dy * farthest;
  std::vector<double> sums(static_cast<std::size_t>(2 * farthest + 1), 0.0);
  int edges = 0;
  const auto step_at = [&](int x, int y) {
    return std::abs(pair.grey(x + dx * kDepthEdgeReach_px, y + dy * kDepthEdgeReach_px) -
                    pair.grey(x, y));
  };
  for (int y = margin_y; y + margin_y + kDepthEdgeReach_px < height; ++y) {
    for (int x = margin_x; x + margin_x + kDepthEdgeReach_px < width; ++x) {
      if (!is_depth_edge(pair.depth(x, y),
                         pair.depth(x + dx * kDepthEdgeReach_px, y + dy * kDepthEdgeReach_px))) {
        continue;
      }
      ++edges;
      for (int shift = -farthest; shift <= farthest; ++shift) {
        sums[static_cast<std::size_t>(shift + farthest)] += step_at(x + shift * dx, y + shift * dy);
      }
    }
  }
  double total = 0;
  for (const double sum : sums) total += sum;
  if (edges < kFewestSeams || total <= 0) return {};
  for (double& sum : sums) sum *= static_cast<double>(sums.size()) / total;
  return sums;
}

std::vector<double> mean_of(const std::vector<std::vector<double>>& curves, std::size_t first,
                            std::size_t last) {
  std::vector<double> mean(curves.front().size(), 0.0);
  for (std::size_t c = first; c < last; ++c) {
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += curves[c][i];
  }
  for (double& m : mean) m /= static_cast<double>(last - first);
  return mean;
}

int best_of(const std::vector<double>& curve) {
  const auto middle = static_cast<std::ptrdiff_t>(curve.size() / 2);
  return static_cast<int>(std::max_element(curve.begin(), curve.end()) - curve.begin() - middle);
}

/// The shift along one axis by which colour is off from depth, if there is no doubt of it; else 0.
int certain_shift(const std::vector<std::vector<double>>& curves) {
  if (curves.size() < kFewestPairs) return 0;
  const std::vector<double> all = mean_of(curves, 0, curves.size());
  const int best = best_of(all), farthest = static_cast<int>(all.size() / 2);
  const auto at = [&](int shift) { return all[static_cast<std::size_t>(shift + farthest)]; };
  if (std::abs(best) < kLeast_px || std::abs(best) == farthest) return 0;
  if (at(best) < kClearlyBetter * at(0)) return 0;
  for (int shift = -farthest; shift <= farthest; ++shift) {
    constexpr int kPeak_px = 3;  // half the width of a peak
    if (std::abs(shift - best) > kPeak_px && at(best) < kClearlyFirst * at(shift)) return 0;
  }
  const std::size_t half = curves.size() / 2;
  const int early = best_of(mean_of(curves, 0, half));
  const int late = best_of(mean_of(curves, half, curves.size()));
  return std::abs(early - best) <= 1 && std::abs(late - best) <= 1 ? best : 0;
}

}  // namespace

Result<DepthShift> parse_depth_shift(const std::string& text) {
  constexpr int kMost_px = 100;
  DepthShift shift;
  const char* const end = text.data() + text.size();
  const auto right = std::from_chars(text.data(), end, shift.right_px);
  if (right.ec == std::errc() && right.ptr != end && *right.ptr == ',') {
    const auto down = std::from_chars(right.ptr + 1, end, shift.down_px);
    const bool small = std::abs(shift.right_px) <= kMost_px && std::abs(shift.down_px) <= kMost_px;
    if (down.ec == std::errc() && down.ptr == end && small) return shift;
  }
  return Error{
      fmt::format("expected whole pixels RIGHT,DOWN (at most {}), found '{}'", kMost_px, text)};
}

DepthShift estimate_depth_shift(std::size_t count,
                                const std::function<Result<LaidPair>(std::size_t)>& read) {
  std::vector<std::vector<double>> right, down;
  const std::size_t step = std::max<std::size_t>(1, count / kPairs);
  for (std::size_t i = step / 2; i < count; i += step) {
    const Result<LaidPair> pair = read(i);
    if (!pair || pair->grey.width() != pair->depth.width() ||
        pair->grey.height() != pair->depth.height()) {
      continue;
    }
    const int farthest = std::max(2 * kLeast_px, kFarthestShift_px * pair->grey.width() / 640);
    if (!right.empty() && right.front().size() != static_cast<std::size_t>(2 * farthest + 1)) {
      continue;
    }
    if (auto curve = agreement(*pair, Axis::x, farthest); !curve.empty()) right.push_back(curve);
    if (auto curve = agreement(*pair, Axis::y, farthest); !curve.empty()) down.push_back(curve);
  }
  // Where colour is off to the left, depth is off to the right.
  return {-certain_shift(right), -certain_shift(down)};
}

DepthImage laid_over(const DepthImage& depth_m, const DepthShift& shift) {
  std::vector<float> out(static_cast<std::size_t>(depth_m.width()) * depth_m.height(), 0.0F);
  for (int y = 0; y < depth_m.height(); ++y) {
    for (int x = 0; x < depth_m.width(); ++x) {
      if (!depth_m.contains(x + shift.right_px, y + shift.down_px)) continue;
      out[static_cast<std::size_t>(y) * depth_m.width() + x] =
          depth_m(x + shift.right_px, y + shift.down_px);
    }
  }
  return {depth_m.width(), depth_m.height(), std::move(out)};
}

}  // namespace ydd
