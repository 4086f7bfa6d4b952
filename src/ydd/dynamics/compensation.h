// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/dynamics/dynamics_options.h"

namespace ydd {

/// How many points the next frame asks for after `rejected` of `extracted` points were rejected:
/// `N / (1 - eta)` with eta = rejected / extracted, times `boost` when eta is above `boost_above`,
/// at most `most_points` (article, equations 8 to 10). The extractor spreads them over the pyramid.
/// After a static frame or one without points: N. @throws std::logic_error unless 0 <= rejected <=
/// extracted.
int next_budget(int extracted, int rejected, bool dynamic_frame,
                const CompensationOptions& options);

}  // namespace ydd
