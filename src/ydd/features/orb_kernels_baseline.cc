// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_kernels.inc"

namespace ydd {

const OrbKernels kBaselineOrbKernels = {simd::kInstructionSet,
                                        score_row,
                                        find_maxima,
                                        blur_columns,
                                        blur_along,
                                        shrink_row,
                                        blend_rows,
                                        moments};

}  // namespace ydd
