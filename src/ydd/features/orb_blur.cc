// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_blur.h"

#include "ydd/features/simd.h"

namespace ydd {
namespace {

using simd::U8;

using simd::kLanes8;

// (1 2 1) / 4
U8 smooth(U8 a, U8 b, U8 c) { return simd::average(simd::average(a, c), b); }

// (1 2 3 4 3 2 1) / 16 is (1 2 1) / 4 followed by (1 0 2 0 1) / 4. The average instruction rounds
// up, which brightens the whole image by about a grey level and changes no comparison.
template <class At>
U8 smooth_seven(At at) {
  return smooth(smooth(at(-3), at(-2), at(-1)), smooth(at(-1), at(0), at(1)),
                smooth(at(1), at(2), at(3)));
}

}  // namespace

GreyView OrbBlur::apply(const GreyView& view) {
  const std::ptrdiff_t stride = (view.width + 63) / 64 * 64 | 64;
  pixels_.resize(static_cast<std::size_t>(stride * view.height));
  row_.resize(static_cast<std::size_t>(view.width + 2 * kLanes8));
  // The last vector overlaps the one before rather than running over the end of the row.
  const auto each_vector = [](int end, auto&& body) {
    for (int x = 0; x < end; x += kLanes8) body(x < end - kLanes8 ? x : end - kLanes8);
  };
  for (int y = kRadius_px; y < view.height - kRadius_px; ++y) {
    const std::uint8_t* in = view.row(y);
    each_vector(view.width, [&](int x) {
      const auto at = [&](int dy) { return simd::load(in + dy * view.stride + x); };
      simd::store(row_.data() + x, smooth_seven(at));
    });
    std::uint8_t* out = pixels_.data() + y * stride;
    each_vector(view.width - 2 * kRadius_px, [&](int i) {
      const int x = i + kRadius_px;
      const auto at = [&](int dx) { return simd::load(row_.data() + x + dx); };
      simd::store(out + x, smooth_seven(at));
    });
  }
  return {pixels_.data(), view.width, view.height, stride};
}

}  // namespace ydd
