// SPDX-License-Identifier: Apache-2.0
#include "ydd/evaluation/error_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace ydd {

ErrorStatistics error_statistics(std::span<const double> errors) {
  ErrorStatistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());
  s.mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / n;
  double squares = 0;
  double squared_deviations = 0;
  for (const double error : sorted) {
    squares += error * error;
    squared_deviations += (error - s.mean) * (error - s.mean);
  }
  s.rmse = std::sqrt(squares / n);
  s.sd = std::sqrt(squared_deviations / n);
  s.median = 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
  s.min = sorted.front();
  s.max = sorted.back();
  return s;
}

}  // namespace ydd
