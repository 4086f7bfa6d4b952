// SPDX-License-Identifier: Apache-2.0
#ifdef YDD_WITH_ONEDNN
#include "ydd/inference/onednn_kernels.h"

#include <optional>
#include <stdexcept>

#include "ydd/inference/onednn_versions.h"

namespace ydd {
namespace {

using dnnl::memory;
using Convolution = dnnl::convolution_forward;

dnnl::algorithm algorithm_of(Activation activation) {
  switch (activation) {
    case Activation::silu:
      return dnnl::algorithm::eltwise_swish;
    case Activation::sigmoid:
      return dnnl::algorithm::eltwise_logistic;
    case Activation::relu:
    case Activation::leaky_relu:
      return dnnl::algorithm::eltwise_relu;
    case Activation::none:
      break;
  }
  throw std::logic_error("OnednnPlan: no activation");
}

/// The parameter of that algorithm.
float alpha_of(const Layer& layer) {
  if (layer.activation == Activation::silu) return 1.0F;
  return layer.activation == Activation::leaky_relu ? layer.slope : 0.0F;
}

dnnl::primitive_attr attributes_of(const Layer& layer, bool activates, bool adds) {
  dnnl::post_ops after_it;
  if (activates && layer.activation != Activation::none) append_activation(after_it, layer, 1.0F);
  if (adds && layer.residual) after_it.append_sum(1.0F);
  dnnl::primitive_attr attributes;
  attributes.set_post_ops(after_it);
  return attributes;
}

/// oneDNN's first answer to this form of the problem that is no reference, if there is one.
std::optional<Convolution::primitive_desc> ask(const ConvolutionProblem& problem,
                                               const dnnl::primitive_attr& attributes,
                                               bool any_destination, const dnnl::engine& engine) {
  const Layer& layer = problem.layer;
  Convolution::primitive_desc kernel = onednn::convolution(
      problem.any_source_layout ? onednn::in_any_layout(problem.source) : problem.source,
      {convolution_weight_dims(layer), onednn::type_of(problem.source), memory::format_tag::any},
      {{layer.weights.dims[0]}, memory::data_type::f32, memory::format_tag::a},
      any_destination ? onednn::in_any_layout(problem.destination) : problem.destination,
      {dims_of(layer.window.kernel), dims_of(layer.window.stride),
       dims_of(layer.window.dilation, 1), dims_of(layer.window.pad_begin),
       dims_of(layer.window.pad_end)},
      attributes, engine);
  if (!kernel) return std::nullopt;
  while (is_reference(kernel.impl_info_str())) {
    if (!kernel.next_impl()) return std::nullopt;
  }
  return kernel;
}

}  // namespace

void append_activation(dnnl::post_ops& after_it, const Layer& layer, float scale) {
  onednn::append_activation(after_it, algorithm_of(layer.activation), alpha_of(layer), scale);
}

memory::dims dims_of(const std::array<int, 2>& pair, int less) {
  return {pair[0] - less, pair[1] - less};
}

bool is_reference(const std::string& implementation) {
  return implementation.rfind("ref", 0) == 0 || implementation.find(":ref") != std::string::npos;
}

bool is_compiled(const std::string& implementation) {
  return implementation.rfind("jit", 0) == 0 || implementation.rfind("brg", 0) == 0;
}

memory::dims convolution_weight_dims(const Layer& layer) {
  const memory::dims& w = layer.weights.dims;
  const memory::dim groups = layer.groups;
  return groups == 1 ? w : memory::dims{groups, w[0] / groups, w[1], w[2], w[3]};
}

ConvolutionKernel choose_convolution(const ConvolutionProblem& problem,
                                     const dnnl::engine& engine) {
  struct Form {
    bool activates, adds, any_destination;
  };
  // From nothing left to do to most: each other pass reads and writes the map once more.
  constexpr Form kForms[] = {{true, true, false},
                             {true, false, false},
                             {true, false, true},
                             {false, false, false},
                             {false, false, true}};
  std::optional<ConvolutionKernel> general;
  for (const Form& form : kForms) {
    const auto kernel = ask(problem, attributes_of(problem.layer, form.activates, form.adds),
                            form.any_destination, engine);
    if (!kernel) continue;
    ConvolutionKernel found{*kernel, form.activates, form.adds};
    if (is_compiled(kernel->impl_info_str())) return found;
    if (!general) general = found;
  }
  if (general) return *general;
  throw std::runtime_error("oneDNN has no kernel for a convolution of the network here");
}

dnnl::eltwise_forward::primitive_desc choose_activation(const Layer& layer, const memory::desc& map,
                                                        const dnnl::engine& engine) {
  return without_reference(
      onednn::activation(map, algorithm_of(layer.activation), alpha_of(layer), engine),
      "an activation of the network here");
}

}  // namespace ydd
#endif
