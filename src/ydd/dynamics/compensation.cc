// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/compensation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ydd {

int next_budget(int extracted, int rejected, bool dynamic_frame,
                const CompensationOptions& options) {
  if (rejected < 0 || rejected > extracted) {
    throw std::logic_error("next_budget: rejected points must be among the extracted ones");
  }
  // A limit below N must not take points from a static frame.
  const int most = std::max(options.points, options.most_points);
  if (!dynamic_frame || extracted == 0) return options.points;
  if (rejected == extracted) return most;
  const double eta = static_cast<double>(rejected) / extracted;
  const double boost = eta > options.boost_above ? options.boost : 1.0;
  return static_cast<int>(std::min<double>(most, std::round(options.points / (1 - eta) * boost)));
}

}  // namespace ydd
