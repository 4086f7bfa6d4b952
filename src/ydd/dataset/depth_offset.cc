// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/depth_offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <vector>

#include "ydd/base/timing.h"
#include "ydd/dataset/association.h"
#include "ydd/dataset/depth_edges.h"

namespace ydd {
namespace {

constexpr double kFarthest_s = 0.25;
constexpr int kMostShift = 8;          // depth images from the nearest one
constexpr std::size_t kPictures = 40;  // colour images that are looked at
constexpr std::size_t kFewest = 5;     // of them that must tell something
constexpr double kFewestEdges = 200;

struct Sums {
  double all = 0, at_edges = 0, pixels = 0, edges = 0;
  void add(int step, bool edge) {
    all += step;
    pixels += 1;
    if (!edge) return;
    at_edges += step;
    edges += 1;
  }
};

/// Of one colour image: how well it agrees with the depth image so many places from the nearest,
/// relative to its mean over all of them.
using ByShift = std::map<int, double>;

struct Shifts {
  std::vector<ByShift> agreements;             ///< one for each colour image that tells something
  std::map<int, std::vector<double>> later_s;  ///< depth minus colour stamps
};

Result<ByShift> agreements_of(std::size_t c, std::span<const Timestamp> colour,
                              std::span<const Timestamp> depth, const PictureReaders& read,
                              Shifts& shifts) {
  const Result<GreyImage> grey = read.colour(c);
  if (!grey) return grey.error();
  ByShift found;
  double sum = 0;
  const auto nearest = static_cast<int>(nearest_index(depth, colour[c]));
  for (int shift = -kMostShift; shift <= kMostShift; ++shift) {
    const int d = nearest + shift;
    if (d < 0 || d >= static_cast<int>(depth.size())) continue;
    const double later_s = seconds_between(colour[c], depth[static_cast<std::size_t>(d)]);
    if (std::abs(later_s) > kFarthest_s) continue;
    const Result<RawDepthImage> image = read.depth(static_cast<std::size_t>(d));
    if (!image) return image.error();
    const std::optional<double> agreement = edge_agreement(*grey, *image);
    if (!agreement) return ByShift{};
    shifts.later_s[shift].push_back(later_s);
    found[shift] = *agreement;
    sum += *agreement;
  }
  for (auto& [shift, agreement] : found) agreement *= static_cast<double>(found.size()) / sum;
  return found;
}

double mean_at(const Shifts& shifts, int shift) {
  std::vector<double> values;
  for (const ByShift& one : shifts.agreements) {
    if (const auto at = one.find(shift); at != one.end()) values.push_back(at->second);
  }
  return values.size() < kFewest ? 0 : statistics_of(values).mean;
}

/// Whether `shift` agrees better than none by more than chance: paired differences, two standard
/// errors and a part in two hundred.
bool is_clearly_better(const Shifts& shifts, int shift) {
  std::vector<double> gains;
  for (const ByShift& one : shifts.agreements) {
    const auto at = one.find(shift), none = one.find(0);
    if (at != one.end() && none != one.end()) gains.push_back(at->second - none->second);
  }
  if (gains.size() < kFewest) return false;
  const double mean = statistics_of(gains).mean;
  double squares = 0;
  for (const double gain : gains) squares += (gain - mean) * (gain - mean);
  const auto count = static_cast<double>(gains.size());
  const double standard_error = std::sqrt(squares / (count - 1) / count);
  return mean > 2 * standard_error && mean > 0.005;
}

/// Where the parabola through the best shift and its neighbours is highest.
double peak_s(const Shifts& shifts, int best) {
  const auto later_s = [&](int shift) { return statistics_of(shifts.later_s.at(shift)).median; };
  const double before = mean_at(shifts, best - 1), at = mean_at(shifts, best),
               after = mean_at(shifts, best + 1);
  const double curvature = before - 2 * at + after;
  if (before == 0 || after == 0 || curvature >= 0) return later_s(best);
  const double places = 0.5 * (before - after) / curvature;
  return later_s(best) + places * 0.5 * (later_s(best + 1) - later_s(best - 1));
}

}  // namespace

std::optional<double> edge_agreement(const GreyImage& grey, const RawDepthImage& depth) {
  if (grey.width() != depth.width() || grey.height() != depth.height()) return std::nullopt;
  constexpr int kReach = kDepthEdgeReach_px;
  Sums sums;
  for (int y = 0; y + kReach < grey.height(); y += 2) {
    for (int x = 0; x + kReach < grey.width(); ++x) {
      for (const auto& [dx, dy] : {std::array{kReach, 0}, std::array{0, kReach}}) {
        sums.add(std::abs(grey(x + dx, y + dy) - grey(x, y)),
                 is_depth_edge(depth(x, y), depth(x + dx, y + dy)));
      }
    }
  }
  if (sums.edges < kFewestEdges || sums.all == 0) return std::nullopt;
  return (sums.at_edges / sums.edges) / (sums.all / sums.pixels);
}

Result<double> estimate_depth_offset_s(std::span<const Timestamp> colour,
                                       std::span<const Timestamp> depth,
                                       const PictureReaders& read) {
  if (colour.empty() || depth.empty()) throw std::logic_error("estimate_depth_offset_s: no images");
  Shifts shifts;
  const std::size_t step = std::max<std::size_t>(1, colour.size() / kPictures);
  for (std::size_t c = step / 2; c < colour.size(); c += step) {
    Result<ByShift> agreements = agreements_of(c, colour, depth, read, shifts);
    if (!agreements) return agreements.error();
    if (!agreements->empty()) shifts.agreements.push_back(*std::move(agreements));
  }
  if (mean_at(shifts, 0) == 0) {
    return Error{
        "the pictures do not tell the offset between colour and depth (too few of them show edges "
        "of depth); give it in seconds"};
  }
  int best = 0;
  for (const auto& [shift, later_s] : shifts.later_s) {
    if (mean_at(shifts, shift) > mean_at(shifts, best)) best = shift;
  }
  return is_clearly_better(shifts, best) ? -peak_s(shifts, best) : 0.0;
}

}  // namespace ydd
