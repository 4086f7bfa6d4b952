// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/viewpoint.h"

#include <algorithm>
#include <cmath>

namespace ydd {

int predicted_octave(const PyramidScales& scales, double max_distance_m, double distance_m) {
  const double steps = std::log(max_distance_m / distance_m) / scales.log_step;
  return std::clamp(static_cast<int>(std::ceil(steps)), 0, scales.levels() - 1);
}

}  // namespace ydd
