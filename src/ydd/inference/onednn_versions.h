// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <vector>

#include <dnnl.hpp>

/// What the interfaces of oneDNN 2 and 3 spell differently, under one name each. Only files of the
/// room that are compiled with oneDNN include this.
namespace ydd::onednn {

using Desc = dnnl::memory::desc;
using Dims = dnnl::memory::dims;

/// Windows of convolutions and poolings.
struct WindowDims {
  Dims kernel, stride, dilation, pad_begin, pad_end;  ///< dilation 0: none
};

#if DNNL_VERSION_MAJOR >= 3
inline Desc in_any_layout(const Desc& map) {
  return {map.get_dims(), map.get_data_type(), dnnl::memory::format_tag::any};
}
inline dnnl::memory::data_type type_of(const Desc& map) { return map.get_data_type(); }

/// Scales that are known when a kernel is made, as 8-bit integers need them here. Version 3 takes
/// them with every call instead, which nobody has tried.
inline constexpr bool kHasFixedScales = false;
inline void scale_outputs(dnnl::primitive_attr&, int, const std::vector<float>&) {
  throw std::logic_error("oneDNN 3 has no fixed scales");
}

/// What is activated is multiplied by `scale`.
inline void append_activation(dnnl::post_ops& ops, dnnl::algorithm algorithm, float alpha,
                              float scale) {
  if (scale != 1.0F) throw std::logic_error("oneDNN 3 has no fixed scales");
  ops.append_eltwise(algorithm, alpha, 0.0F);
}

/// Empty where there is no kernel.
inline dnnl::convolution_forward::primitive_desc convolution(
    const Desc& source, const Desc& weights, const Desc& bias, const Desc& destination,
    const WindowDims& window, const dnnl::primitive_attr& attributes, const dnnl::engine& engine) {
  return {engine,
          dnnl::prop_kind::forward_inference,
          dnnl::algorithm::convolution_direct,
          source,
          weights,
          bias,
          destination,
          window.stride,
          window.dilation,
          window.pad_begin,
          window.pad_end,
          attributes,
          /*allow_empty=*/true};
}

inline dnnl::pooling_forward::primitive_desc max_pooling(const Desc& source,
                                                         const Desc& destination,
                                                         const WindowDims& window,
                                                         const dnnl::engine& engine) {
  return {engine,
          dnnl::prop_kind::forward_inference,
          dnnl::algorithm::pooling_max,
          source,
          destination,
          window.stride,
          window.kernel,
          window.dilation,
          window.pad_begin,
          window.pad_end};
}

inline dnnl::eltwise_forward::primitive_desc activation(const Desc& map, dnnl::algorithm algorithm,
                                                        float alpha, const dnnl::engine& engine) {
  return {engine, dnnl::prop_kind::forward_inference, algorithm, map, map, alpha, 0.0F};
}

inline dnnl::binary::primitive_desc binary(dnnl::algorithm algorithm, const Desc& a, const Desc& b,
                                           const Desc& to, const dnnl::engine& engine) {
  return {engine, algorithm, a, b, to};
}

/// Everything that the processor has.
inline constexpr dnnl::cpu_isa kEveryIsa = dnnl::cpu_isa::isa_default;
#else
inline Desc in_any_layout(const Desc& map) {
  return {map.dims(), map.data_type(), dnnl::memory::format_tag::any};
}
inline dnnl::memory::data_type type_of(const Desc& map) { return map.data_type(); }

inline constexpr bool kHasFixedScales = true;
inline void scale_outputs(dnnl::primitive_attr& attributes, int mask,
                          const std::vector<float>& scales) {
  attributes.set_output_scales(mask, scales);
}

inline void append_activation(dnnl::post_ops& ops, dnnl::algorithm algorithm, float alpha,
                              float scale) {
  ops.append_eltwise(scale, algorithm, alpha, 0.0F);
}

/// Empty where there is no kernel.
inline dnnl::convolution_forward::primitive_desc convolution(
    const Desc& source, const Desc& weights, const Desc& bias, const Desc& destination,
    const WindowDims& window, const dnnl::primitive_attr& attributes, const dnnl::engine& engine) {
  return {{dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct, source, weights,
           bias, destination, window.stride, window.dilation, window.pad_begin, window.pad_end},
          attributes,
          engine,
          /*allow_empty=*/true};
}

inline dnnl::pooling_forward::primitive_desc max_pooling(const Desc& source,
                                                         const Desc& destination,
                                                         const WindowDims& window,
                                                         const dnnl::engine& engine) {
  return {{dnnl::prop_kind::forward_inference, dnnl::algorithm::pooling_max, source, destination,
           window.stride, window.kernel, window.pad_begin, window.pad_end},
          engine};
}

inline dnnl::eltwise_forward::primitive_desc activation(const Desc& map, dnnl::algorithm algorithm,
                                                        float alpha, const dnnl::engine& engine) {
  return {{dnnl::prop_kind::forward_inference, algorithm, map, alpha, 0.0F}, engine};
}

inline dnnl::binary::primitive_desc binary(dnnl::algorithm algorithm, const Desc& a, const Desc& b,
                                           const Desc& to, const dnnl::engine& engine) {
  return {{algorithm, a, b, to}, engine};
}

/// Everything that the processor has.
inline constexpr dnnl::cpu_isa kEveryIsa = dnnl::cpu_isa::all;
#endif

}  // namespace ydd::onednn
