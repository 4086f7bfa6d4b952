// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/inference/layers.h"

namespace ydd {

/// 8-bit integers for a network of 32-bit floats (post-training quantisation, symmetric as in
/// Krishnamoorthi 2018, arXiv:1806.08342): a feature map holds round(x / step) in [-127, 127] with
/// one step, the weights of a convolution have a step for each of its output channels.

/// The step of every value of `graph`, by value; 0 for those in `wide` (wide_values()), which stay
/// floats. `ranges` are the largest magnitudes that the input of each convolution takes on ordinary
/// pictures, in the order of the layers; larger values saturate. What is only put together, pooled
/// or repeated has one step, so that no number changes on the way.
///
/// Fails when there is not one range for each convolution, one is not a positive number, or the
/// network has something outside of its convolutions that would need to calculate.
Result<std::vector<float>> value_steps(const LayerGraph& graph, const std::vector<bool>& wide,
                                       std::span<const float> ranges);

/// The weights of a convolution as 8-bit integers, each times the step of its output channel.
struct QuantisedWeights {
  std::vector<std::int8_t> values;  ///< in the order of Layer::weights
  std::vector<float> steps;         ///< by output channel
};
QuantisedWeights quantise_weights(const Layer& convolution);

}  // namespace ydd
