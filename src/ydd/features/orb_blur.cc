// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_blur.h"

#include "ydd/features/orb_kernels.h"

namespace ydd {
GreyView OrbBlur::apply(const GreyView& view) {
  const OrbKernels& kernels = orb_kernels();
  const std::ptrdiff_t stride = (view.width + 63) / 64 * 64 | 64;
  pixels_.resize(static_cast<std::size_t>(stride * view.height));
  row_.resize(static_cast<std::size_t>(view.width + 2 * kOrbVector_px));
  for (int y = kRadius_px; y < view.height - kRadius_px; ++y) {
    kernels.blur_columns(view.row(y), view.stride, view.width, row_.data());
    kernels.blur_along(row_.data(), kRadius_px, view.width - kRadius_px,
                       pixels_.data() + y * stride);
  }
  return {pixels_.data(), view.width, view.height, stride};
}

}  // namespace ydd
