// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace ydd {

/// Summary of a series of errors, in its unit; all zero when it is empty.
struct ErrorStatistics {
  std::size_t count = 0;  ///< of errors that it sums up
  double rmse = 0;        ///< root of the mean of their squares
  double mean = 0;        ///< their sum by count
  double median = 0;      ///< of an even number: the mean of the middle two
  double sd = 0;          ///< of the population (divided by count)
  double min = 0;         ///< the smallest of them
  double max = 0;         ///< the largest of them
};

ErrorStatistics error_statistics(std::span<const double> errors);  ///< In the unit of the errors.

}  // namespace ydd
