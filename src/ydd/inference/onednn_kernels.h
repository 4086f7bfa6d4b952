// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include <dnnl.hpp>

#include "ydd/inference/layers.h"

namespace ydd {

/// oneDNN always has an answer: where it has no kernel for a processor, a reference implementation
/// that is a hundred times slower. No plan may hold one of those.
bool is_reference(const std::string& implementation);
/// Blocked kernels are compiled for the layout; general ones unfold the windows for a product of
/// matrices.
bool is_compiled(const std::string& implementation);

/// A convolution in the terms of oneDNN. Maps lie channels last.
struct ConvolutionProblem {
  const Layer& layer;
  dnnl::memory::desc source, destination;
  bool any_source_layout = false;  ///< the input of the network is laid out anew anyway
};

/// The kernel of one convolution. What it cannot do in the same pass is done in another one.
struct ConvolutionKernel {
  dnnl::convolution_forward::primitive_desc kernel;
  bool activates = true;  ///< the activation is part of it
  bool adds = true;       ///< so is the residual
};

/// The kernel that leaves least to do in other passes, among those that are no reference.
///
/// AVX-512 has kernels for everything in one pass. AVX2 and SSE4.1 have none that adds after the
/// activation, nor for all layouts.
/// @throws dnnl::error, std::runtime_error where there is none.
ConvolutionKernel choose_convolution(const ConvolutionProblem& problem, const dnnl::engine& engine);

/// The activation of `layer`, times `scale`, after what `after_it` already does.
void append_activation(dnnl::post_ops& after_it, const Layer& layer, float scale);

dnnl::eltwise_forward::primitive_desc choose_activation(const Layer& layer,
                                                        const dnnl::memory::desc& map,
                                                        const dnnl::engine& engine);

/// Rows and columns of a window, each `less`.
dnnl::memory::dims dims_of(const std::array<int, 2>& pair, int less = 0);
dnnl::memory::dims convolution_weight_dims(const Layer& layer);

/// The first kernel that is no reference. @throws std::runtime_error where there is none.
template <class PrimitiveDesc>
PrimitiveDesc without_reference(PrimitiveDesc kernel, const char* what) {
  while (is_reference(kernel.impl_info_str())) {
    if (!kernel.next_impl()) {
      throw std::runtime_error(std::string("oneDNN has no kernel for ") + what);
    }
  }
  return kernel;
}

}  // namespace ydd
