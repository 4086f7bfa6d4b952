// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/pairing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "ydd/base/timing.h"

namespace ydd {
namespace {

/// Seconds from each stamp to the next.
double median_interval_s(std::span<const Timestamp> stamps) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    intervals_s.push_back(seconds_between(stamps[i - 1], stamps[i]));
  }
  return statistics_of(intervals_s).median;
}

/// Depth minus colour, of each pair.
std::vector<double> differences_s(std::span<const Timestamp> colour,
                                  std::span<const Timestamp> depth,
                                  std::span<const IndexPair> pairs) {
  std::vector<double> out;
  out.reserve(pairs.size());
  for (const auto& [c, d] : pairs) out.push_back(seconds_between(colour[c], depth[d]));
  return out;
}

/// A clock that is off shows as one difference that is late in nearly all pairs. A quarter of the
/// frame interval is more than two free-running cameras of one recording keep up.
bool are_steadily_late(const std::vector<double>& differences, double median_s, double interval_s) {
  constexpr double kLate = 0.25, kSpread = 0.1;  // of the interval
  constexpr double kMost = 0.9;                  // of the pairs
  if (differences.size() < 3 || std::abs(median_s) < kLate * interval_s) return false;
  const auto near = std::count_if(differences.begin(), differences.end(), [&](double d) {
    return std::abs(d - median_s) < kSpread * interval_s;
  });
  return static_cast<double>(near) >= kMost * static_cast<double>(differences.size());
}

/// The difference of stamps, in nanoseconds, that most (colour, depth) share within the tolerance.
std::int64_t commonest_difference_ns(std::span<const Timestamp> colour,
                                     std::span<const Timestamp> depth, std::int64_t tolerance_ns) {
  constexpr std::size_t kAsked = 64;  // images of each list: what most share, these share
  const auto some = [](std::span<const Timestamp> stamps) {
    std::vector<Timestamp> out;
    const std::size_t step = std::max<std::size_t>(1, stamps.size() / kAsked);
    for (std::size_t i = 0; i < stamps.size(); i += step) out.push_back(stamps[i]);
    return out;
  };
  std::vector<std::int64_t> all;
  for (const Timestamp c : some(colour)) {
    for (const Timestamp d : depth) all.push_back(d.ns - c.ns);
  }
  std::sort(all.begin(), all.end());
  std::size_t first = 0, best_first = 0, best_last = 0;
  for (std::size_t last = 0; last < all.size(); ++last) {
    while (all[last] - all[first] > tolerance_ns) ++first;
    if (last - first > best_last - best_first) best_first = first, best_last = last;
  }
  return all[best_first + (best_last - best_first) / 2];
}

}  // namespace

Pairing judge_pairing(std::span<const Timestamp> colour, std::span<const Timestamp> depth,
                      std::span<const IndexPair> pairs, double max_difference_s,
                      double depth_offset_s) {
  Pairing out;
  out.colour_images = colour.size();
  out.depth_images = depth.size();
  out.pairs = pairs.size();
  out.depth_offset_s = depth_offset_s;
  const std::vector<double> differences = differences_s(colour, depth, pairs);
  out.depth_later_s = statistics_of(differences).median;
  out.steadily_late = are_steadily_late(differences, out.depth_later_s, median_interval_s(colour));
  const std::size_t possible = std::min(colour.size(), depth.size());
  if (pairs.size() >= possible - possible / 20 || possible == 0) return out;
  const std::int64_t shift_ns =
      commonest_difference_ns(colour, depth, std::llround(max_difference_s * 1e9));
  std::vector<Timestamp> shifted(depth.begin(), depth.end());
  for (Timestamp& stamp : shifted) stamp.ns -= shift_ns;
  const std::size_t fitting = associate(colour, shifted, max_difference_s).size();
  if (fitting <= pairs.size() + pairs.size() / 10) return out;
  out.fitting_offset_s = depth_offset_s - static_cast<double>(shift_ns) * 1e-9;
  out.fitting_pairs = fitting;
  return out;
}

std::string pairing_warning(const Pairing& pairing, double max_difference_s) {
  constexpr double kFew = 0.05;
  const std::size_t possible = std::min(pairing.colour_images, pairing.depth_images);
  const std::size_t missing = possible - pairing.pairs;
  if (static_cast<double>(missing) > kFew * static_cast<double>(possible)) {
    std::string text = fmt::format(
        "only {} of {} colour images have a depth image within {:g} s, and the others are left out",
        pairing.pairs, pairing.colour_images, max_difference_s);
    if (pairing.fitting_pairs == 0) return text + "; check the stamps in rgb.txt and depth.txt";
    return text + fmt::format("; with --depth-offset={:.6g} {} would have one",
                              pairing.fitting_offset_s, pairing.fitting_pairs);
  }
  if (!pairing.steadily_late) return "";
  return fmt::format(
      "the depth image of every pair is {:.1f} ms {} than its colour image: depth may belong to "
      "another frame; --depth-offset auto looks at the pictures and finds out",
      1e3 * std::abs(pairing.depth_later_s), pairing.depth_later_s > 0 ? "later" : "earlier");
}

}  // namespace ydd
