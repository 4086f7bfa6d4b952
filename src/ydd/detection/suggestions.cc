// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/suggestions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>

namespace ydd {
namespace {

double tenths(float px) { return std::round(static_cast<double>(px) * 10) / 10; }

std::size_t distance(std::size_t a, std::size_t b) { return a > b ? a - b : b - a; }

}  // namespace

double doubt(const Detections& detections) {
  return std::accumulate(detections.begin(), detections.end(), 0.0,
                         [](double sum, const Detection& d) {
                           const double s = std::clamp(static_cast<double>(d.score), 0.0, 1.0);
                           return sum + 4 * s * (1 - s);
                         });
}

std::vector<std::size_t> most_doubtful(std::span<const double> doubts, std::size_t count,
                                       std::size_t gap) {
  std::vector<std::size_t> order(doubts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return doubts[a] > doubts[b]; });
  std::vector<std::size_t> chosen;
  for (const std::size_t candidate : order) {
    if (chosen.size() >= count || doubts[candidate] <= 0) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](std::size_t other) {
      return distance(other, candidate) < gap;
    });
    if (!near) chosen.push_back(candidate);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::string training_labels(const Detections& detections) {
  nlohmann::json out = {{"boxes", nlohmann::json::array()}, {"ignore", nlohmann::json::array()}};
  for (const Detection& d : detections) {
    out[d.score >= kProposedScore ? "boxes" : "ignore"].push_back(
        {d.class_name, tenths(d.box.x0), tenths(d.box.y0), tenths(d.box.x1), tenths(d.box.y1)});
  }
  return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace ydd
