// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace ydd {

/// Summary of a series of errors, in its unit; all zero when it is empty.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0;
  double mean = 0;
  double median = 0;  ///< of an even number: the mean of the middle two
  double sd = 0;      ///< of the population (divided by count)
  double min = 0;
  double max = 0;
};

ErrorStatistics error_statistics(std::span<const double> errors);

}  // namespace ydd
