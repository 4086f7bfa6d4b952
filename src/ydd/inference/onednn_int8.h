// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dnnl.hpp>

#include "ydd/inference/onednn_kernels.h"

namespace ydd {

/// What one step of the maps around a convolution stands for; 0: a map of floats.
struct ConvolutionSteps {
  float source = 0, destination = 0, residual = 0;
};

/// A convolution of 8-bit maps with 8-bit weights that does all in one pass: activation, sum,
/// rounding to 8 bits.
struct Int8Convolution {
  dnnl::convolution_forward::primitive_desc kernel;
  dnnl::memory weights, bias;  ///< as the kernel takes them
};

/// @throws std::runtime_error where oneDNN has no such kernel that is no reference.
Int8Convolution make_int8_convolution(const ConvolutionProblem& problem,
                                      const ConvolutionSteps& steps, const dnnl::engine& engine);

}  // namespace ydd
