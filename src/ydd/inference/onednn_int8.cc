// SPDX-License-Identifier: Apache-2.0
#ifdef YDD_WITH_ONEDNN
#include "ydd/inference/onednn_int8.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "ydd/inference/onednn_versions.h"
#include "ydd/inference/quantisation.h"

namespace ydd {
namespace {

using dnnl::memory;

/// oneDNN adds the products of integers and the bias, scales that to what it stands for, activates,
/// and each post-op scales to steps of the result.
dnnl::primitive_attr int8_attributes(const Layer& layer, const QuantisedWeights& weights,
                                     const ConvolutionSteps& steps) {
  const float to_destination = steps.destination > 0 ? 1.0F / steps.destination : 1.0F;
  const bool activates = layer.activation != Activation::none;
  dnnl::post_ops after_it;
  if (activates) append_activation(after_it, layer, to_destination);
  if (layer.residual) after_it.append_sum(steps.residual * to_destination);
  std::vector<float> scales;
  for (const float step : weights.steps) {
    scales.push_back(step * steps.source * (activates ? 1.0F : to_destination));
  }
  dnnl::primitive_attr attributes;
  attributes.set_post_ops(after_it);
  onednn::scale_outputs(attributes, 1 << 1, scales);
  return attributes;
}

dnnl::convolution_forward::primitive_desc choose_int8(const ConvolutionProblem& problem,
                                                      const dnnl::primitive_attr& attributes,
                                                      const dnnl::engine& engine) {
  const Layer& layer = problem.layer;
  const auto kernel = onednn::convolution(
      problem.source,
      {convolution_weight_dims(layer), memory::data_type::s8, memory::format_tag::any},
      {{layer.weights.dims[0]}, memory::data_type::f32, memory::format_tag::a}, problem.destination,
      {dims_of(layer.window.kernel), dims_of(layer.window.stride),
       dims_of(layer.window.dilation, 1), dims_of(layer.window.pad_begin),
       dims_of(layer.window.pad_end)},
      attributes, engine);
  constexpr const char* kWhat = "a convolution of 8-bit integers here";
  if (!kernel) throw std::runtime_error(std::string("oneDNN has no kernel for ") + kWhat);
  return without_reference(kernel, kWhat);
}

/// In the layout of the kernel, which keeps beside them what it needs to undo an offset of maps.
memory int8_weights(const Layer& layer, const QuantisedWeights& weights, const memory::desc& wanted,
                    const dnnl::engine& engine) {
  const auto plain = layer.groups == 1 ? memory::format_tag::oihw : memory::format_tag::goihw;
  memory held({convolution_weight_dims(layer), memory::data_type::s8, plain}, engine);
  std::memcpy(held.get_data_handle(), weights.values.data(), weights.values.size());
  memory laid(wanted, engine);
  dnnl::stream stream(engine);
  dnnl::reorder(held, laid).execute(stream, held, laid);
  stream.wait();
  return laid;
}

memory int8_bias(const Layer& layer, const QuantisedWeights& weights, float source_step,
                 const dnnl::engine& engine) {
  memory held({{layer.weights.dims[0]}, memory::data_type::f32, memory::format_tag::a}, engine);
  auto* const to = static_cast<float*>(held.get_data_handle());
  const std::vector<float>& bias = layer.bias.floats;
  for (std::size_t c = 0; c < weights.steps.size(); ++c) {
    to[c] = bias.empty() ? 0.0F : bias[c] / (source_step * weights.steps[c]);
  }
  return held;
}

}  // namespace

Int8Convolution make_int8_convolution(const ConvolutionProblem& problem,
                                      const ConvolutionSteps& steps, const dnnl::engine& engine) {
  const QuantisedWeights weights = quantise_weights(problem.layer);
  const auto kernel = choose_int8(problem, int8_attributes(problem.layer, weights, steps), engine);
  return {kernel, int8_weights(problem.layer, weights, kernel.weights_desc(), engine),
          int8_bias(problem.layer, weights, steps.source, engine)};
}

}  // namespace ydd
#endif
