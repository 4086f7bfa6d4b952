// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "ydd/base/result.h"
#include "ydd/image/image.h"

namespace ydd {

/// How far depth lies to the right of colour and below it: registration that is wrong by the first
/// order, as that of a sensor that was bent, or of two cameras that nobody calibrated.
struct DepthShift {
  int right_px = 0, down_px = 0;
  bool none() const { return right_px == 0 && down_px == 0; }
  friend bool operator==(const DepthShift&, const DepthShift&) = default;
};

/// "RIGHT,DOWN" in whole pixels, at most 100 each way. Failure: what was expected.
Result<DepthShift> parse_depth_shift(const std::string& text);

/// A colour picture as grey values and the depth picture that belongs to it.
struct LaidPair {
  GreyImage grey;
  RawDepthImage depth;
};

/// Looks at some of the pairs `0 .. count - 1` and finds how far depth is off. Things end in depth
/// where they end in brightness: the brightness step across the edges of depth, over all shifts up
/// to 12 px (of 640), is largest at the right one. Only what is beyond doubt is told: 2 px and
/// more, far better than no shift, and the same in both halves of the pairs; otherwise none. Pairs
/// that cannot be read are passed over: whoever needs them says so.
DepthShift estimate_depth_shift(std::size_t count,
                                const std::function<Result<LaidPair>(std::size_t)>& read);

/// The picture moved back by the shift; what comes from outside has no reading (0).
DepthImage laid_over(const DepthImage& depth_m, const DepthShift& shift);

}  // namespace ydd
