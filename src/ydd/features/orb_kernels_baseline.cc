// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_kernels.inc"

const ydd::OrbKernels ydd::kBaselineOrbKernels = ydd::kKernels;
