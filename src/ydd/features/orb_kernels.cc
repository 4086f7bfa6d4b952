// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_kernels.h"

namespace ydd {

#ifdef YDD_HAS_AVX2_KERNELS
std::span<const OrbKernels* const> runnable_orb_kernels() {
  static constexpr const OrbKernels* kAll[] = {&kBaselineOrbKernels, &kAvx2OrbKernels};
  static const std::size_t count = __builtin_cpu_supports("avx2") ? 2 : 1;
  return {kAll, count};
}
#else
std::span<const OrbKernels* const> runnable_orb_kernels() {
  static constexpr const OrbKernels* kAll[] = {&kBaselineOrbKernels};
  return kAll;
}
#endif

const OrbKernels& orb_kernels() { return *runnable_orb_kernels().back(); }

}  // namespace ydd
