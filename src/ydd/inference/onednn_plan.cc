// SPDX-License-Identifier: Apache-2.0
#ifdef YDD_WITH_ONEDNN
#include "ydd/inference/onednn_plan.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <unordered_map>

#include <omp.h>
#include <dnnl.hpp>

#include "ydd/inference/layer_shapes.h"
#include "ydd/inference/onednn_int8.h"
#include "ydd/inference/onednn_kernels.h"
#include "ydd/inference/onednn_versions.h"
#include "ydd/inference/quantisation.h"

namespace ydd {
namespace {

using dnnl::memory;
using Arguments = std::unordered_map<int, memory>;
using Type = memory::data_type;
using Step = std::function<void(dnnl::stream&)>;

/// Of the calling thread only; oneDNN takes its number of threads from there.
class OpenMpThreads {
 public:
  explicit OpenMpThreads(int count) : before_(omp_get_max_threads()) { omp_set_num_threads(count); }
  ~OpenMpThreads() { omp_set_num_threads(before_); }
  OpenMpThreads(const OpenMpThreads&) = delete;
  OpenMpThreads& operator=(const OpenMpThreads&) = delete;

 private:
  int before_;
};

Type type_of(MapNumbers numbers) {
  if (numbers == MapNumbers::int8) return Type::s8;
  return numbers == MapNumbers::bfloat16 ? Type::bf16 : Type::f32;
}

memory::dims dims_of(const MapShape& s) { return {1, s.channels, s.rows, s.columns}; }

/// Pixel by pixel, the channels of all inputs.
void concatenate(const std::vector<const std::byte*>& from, const std::vector<std::size_t>& bytes,
                 std::size_t pixels, std::byte* to) {
  for (std::size_t p = 0; p < pixels; ++p) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      std::memcpy(to, from[i] + p * bytes[i], bytes[i]);
      to += bytes[i];
    }
  }
}

/// Every pixel `scale` times in both directions.
void repeat(const std::byte* from, const MapShape& shape, std::size_t pixel_bytes, int scale,
            std::byte* to) {
  const std::size_t row_bytes =
      pixel_bytes * static_cast<std::size_t>(shape.columns) * static_cast<std::size_t>(scale);
  for (int y = 0; y < shape.rows; ++y) {
    std::byte* const row = to;
    for (int x = 0; x < shape.columns; ++x, from += pixel_bytes) {
      for (int i = 0; i < scale; ++i, to += pixel_bytes) std::memcpy(to, from, pixel_bytes);
    }
    for (int i = 1; i < scale; ++i, to += row_bytes) std::memcpy(to, row, row_bytes);
  }
}

const std::byte* bytes_of(const memory& m) {
  return static_cast<const std::byte*>(m.get_data_handle());
}

}  // namespace

struct OnednnPlan::Parts {
  Parts(const LayerGraph& graph, const std::vector<int>& input_shape, const PlanOptions& options)
      : narrow(type_of(options.numbers)) {
    if (input_shape.size() != 4 || input_shape[0] != 1) {
      throw std::runtime_error("the network takes one picture at a time");
    }
    shapes = map_shapes(graph, {input_shape[1], input_shape[2], input_shape[3]});
    wide = wide_values(graph);
    if (options.numbers == MapNumbers::int8) make_value_steps(graph, options.ranges);
    make_values(graph);
    for (const Layer& layer : graph.layers) add_step(layer);
    for (const int output : graph.outputs) add_output(output);
    place_passing();
  }

  const MapShape& shape(int value) const { return shapes[static_cast<std::size_t>(value)]; }
  Type type(int value) const { return wide[static_cast<std::size_t>(value)] ? Type::f32 : narrow; }
  std::size_t pixel_bytes(int value) const {
    return static_cast<std::size_t>(shape(value).channels) * memory::data_type_size(type(value));
  }
  std::size_t pixels(int value) const { return shape(value).pixels(); }
  memory::desc description(int value) const {
    return {dims_of(shape(value)), type(value), memory::format_tag::nhwc};
  }
  memory& at(int value) { return values[static_cast<std::size_t>(value)]; }

  void make_value_steps(const LayerGraph& graph, const std::vector<float>& ranges) {
    Result<std::vector<float>> found = value_steps(graph, wide, ranges);
    if (!found) throw std::runtime_error(found.error().message);
    map_steps = std::move(*found);
  }

  void make_values(const LayerGraph& graph) {
    std::vector<std::size_t> bytes;
    for (int v = 0; v < graph.value_count; ++v) bytes.push_back(pixel_bytes(v) * pixels(v));
    const ValuePlaces places = place_values(graph, bytes);
    block = memory({{static_cast<memory::dim>(places.size_bytes)}, Type::u8, memory::format_tag::a},
                   engine);
    auto* const start = static_cast<std::byte*>(block.get_data_handle());
    for (int v = 0; v < graph.value_count; ++v) {
      if (shape(v).channels == 0) {  // fused away
        values.emplace_back();
      } else {
        values.emplace_back(description(v), engine,
                            start + places.offset_bytes[static_cast<std::size_t>(v)]);
      }
    }
  }

  void add_step(const Layer& layer) {
    switch (layer.kind) {
      case LayerKind::convolution:
        return narrow == Type::s8 ? add_int8_convolution(layer) : add_convolution(layer);
      case LayerKind::max_pool:
        return add_pool(layer);
      case LayerKind::activation:
        return add_activation(layer);
      case LayerKind::add:
        return add_binary(layer, dnnl::algorithm::binary_add);
      case LayerKind::multiply:
        return add_binary(layer, dnnl::algorithm::binary_mul);
      case LayerKind::concat:
        return add_concat(layer);
      case LayerKind::upsample:
        return add_upsample(layer);
    }
  }

  void add_primitive(const dnnl::primitive& primitive, const std::string& implementation,
                     Arguments arguments) {
    implementations.push_back(implementation);
    steps.emplace_back([primitive, arguments = std::move(arguments)](dnnl::stream& on) {
      primitive.execute(on, arguments);
    });
  }

  /// Values from one layout into another, in each run.
  void relay(const memory& from, const memory& to) {
    const dnnl::reorder::primitive_desc chosen(from, to);
    add_primitive(dnnl::reorder(chosen), chosen.impl_info_str(),
                  {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
  }

  /// `from` as a kernel wants it; once for constants, in each run for feature maps.
  memory reordered(const memory& from, const memory::desc& wanted, bool once) {
    if (from.get_desc() == wanted) return from;
    if (!once) {
      memory to = passing(wanted);
      relay(from, to);
      return to;
    }
    memory to(wanted, engine);
    memory source = from;
    dnnl::reorder(source, to).execute(stream, source, to);
    stream.wait();
    return to;
  }

  /// A place for what the next steps of one layer need and nobody after them: all such places
  /// share one block.
  memory passing(const memory::desc& desc) {
    // Two at a time may be in use: what a reorder reads and what it writes.
    const std::size_t side = passing_.size() % 2;
    passing_bytes_[side] = std::max(passing_bytes_[side], desc.get_size());
    passing_.emplace_back(desc, engine, nullptr);
    return passing_.back();
  }

  void place_passing() {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      passing_block_[side] =
          memory({{static_cast<memory::dim>(std::max(passing_bytes_[side], std::size_t{64}))},
                  Type::u8,
                  memory::format_tag::a},
                 engine);
    }
    for (std::size_t i = 0; i < passing_.size(); ++i) {
      passing_[i].set_data_handle(passing_block_[i % 2].get_data_handle());
    }
  }

  memory constant(const OnnxTensor& tensor, const memory::dims& dims, memory::format_tag tag) {
    memory held({dims, Type::f32, tag}, engine);
    std::memcpy(held.get_data_handle(), tensor.floats.data(), tensor.floats.size() * sizeof(float));
    return held;
  }

  void add_convolution(const Layer& layer) {
    const int input = layer.inputs[0];
    const ConvolutionKernel chosen =
        choose_convolution({layer,
                            {dims_of(shape(input)), narrow, memory::format_tag::nhwc},
                            description(layer.output),
                            input == 0},
                           engine);
    const auto& kernel = chosen.kernel;
    const memory::dims weight_dims = convolution_weight_dims(layer);
    const auto plain = layer.groups == 1 ? memory::format_tag::oihw : memory::format_tag::goihw;
    OnnxTensor bias = layer.bias;
    const memory::dim out_channels = layer.weights.dims[0];
    if (bias.floats.empty()) bias.floats.assign(static_cast<std::size_t>(out_channels), 0.0F);
    const memory from = reordered(at(input), kernel.src_desc(), false);
    const memory weights =
        reordered(constant(layer.weights, weight_dims, plain), kernel.weights_desc(), true);
    const bool adds_later = layer.residual && !chosen.adds;
    const bool in_place = !adds_later && kernel.dst_desc() == description(layer.output);
    memory result = in_place ? at(layer.output) : passing(kernel.dst_desc());
    add_primitive(dnnl::convolution_forward(kernel), kernel.impl_info_str(),
                  {{DNNL_ARG_SRC, from},
                   {DNNL_ARG_WEIGHTS, weights},
                   {DNNL_ARG_BIAS, constant(bias, {out_channels}, memory::format_tag::a)},
                   {DNNL_ARG_DST, result}});
    if (layer.activation != Activation::none && !chosen.activates) activate(layer, result, result);
    if (in_place) return;
    if (!adds_later) return relay(result, at(layer.output));
    if (result.get_desc() != description(layer.output)) {
      const memory relaid = passing(description(layer.output));
      relay(result, relaid);
      result = relaid;
    }
    combine(dnnl::algorithm::binary_add, at(*layer.residual), result, at(layer.output));
  }

  void add_int8_convolution(const Layer& layer) {
    const auto step = [&](int value) { return map_steps[static_cast<std::size_t>(value)]; };
    const int input = layer.inputs[0];
    const Int8Convolution chosen = make_int8_convolution(
        {layer, description(input), description(layer.output)},
        {step(input), step(layer.output), layer.residual ? step(*layer.residual) : 0.0F}, engine);
    add_primitive(dnnl::convolution_forward(chosen.kernel), chosen.kernel.impl_info_str(),
                  {{DNNL_ARG_SRC, at(input)},
                   {DNNL_ARG_WEIGHTS, chosen.weights},
                   {DNNL_ARG_BIAS, chosen.bias},
                   {DNNL_ARG_DST, at(layer.output)}});
  }

  void add_pool(const Layer& layer) {
    const int input = layer.inputs[0];
    const auto chosen = without_reference(
        onednn::max_pooling(description(input), description(layer.output),
                            {dims_of(layer.window.kernel), dims_of(layer.window.stride),
                             dims_of(layer.window.dilation, 1), dims_of(layer.window.pad_begin),
                             dims_of(layer.window.pad_end)},
                            engine),
        "a pooling of the network here");
    add_primitive(dnnl::pooling_forward(chosen), chosen.impl_info_str(),
                  {{DNNL_ARG_SRC, at(input)}, {DNNL_ARG_DST, at(layer.output)}});
  }

  void add_activation(const Layer& layer) {
    const memory from = reordered(at(layer.inputs[0]), description(layer.output), false);
    activate(layer, from, at(layer.output));
  }

  void activate(const Layer& layer, const memory& from, const memory& to) {
    const auto chosen = choose_activation(layer, from.get_desc(), engine);
    add_primitive(dnnl::eltwise_forward(chosen), chosen.impl_info_str(),
                  {{DNNL_ARG_SRC, from}, {DNNL_ARG_DST, to}});
  }

  void add_binary(const Layer& layer, dnnl::algorithm algorithm) {
    combine(algorithm, at(layer.inputs[0]), at(layer.inputs[1]), at(layer.output));
  }

  void combine(dnnl::algorithm algorithm, const memory& a, const memory& b, const memory& to) {
    const auto chosen = without_reference(
        onednn::binary(algorithm, a.get_desc(), b.get_desc(), to.get_desc(), engine),
        "a sum of the network here");
    add_primitive(dnnl::binary(chosen), chosen.impl_info_str(),
                  {{DNNL_ARG_SRC_0, a}, {DNNL_ARG_SRC_1, b}, {DNNL_ARG_DST, to}});
  }

  void add_concat(const Layer& layer) {
    std::vector<const std::byte*> from;
    std::vector<std::size_t> bytes;
    for (const int input : layer.inputs) {
      if (type(input) != type(layer.output)) throw std::logic_error("OnednnPlan: mixed precision");
      from.push_back(bytes_of(at(input)));
      bytes.push_back(pixel_bytes(input));
    }
    auto* const to = static_cast<std::byte*>(at(layer.output).get_data_handle());
    steps.emplace_back([from, bytes, count = pixels(layer.output), to](dnnl::stream&) {
      concatenate(from, bytes, count, to);
    });
  }

  void add_upsample(const Layer& layer) {
    const int input = layer.inputs[0];
    auto* const to = static_cast<std::byte*>(at(layer.output).get_data_handle());
    steps.emplace_back([from = bytes_of(at(input)), shape = shape(input), size = pixel_bytes(input),
                        scale = layer.scale,
                        to](dnnl::stream&) { repeat(from, shape, size, scale, to); });
  }

  void add_output(int value) {
    const MapShape& s = shape(value);
    memory floats = at(value);
    if (type(value) != Type::f32) {
      floats = memory({dims_of(s), Type::f32, memory::format_tag::nhwc}, engine);
      relay(at(value), floats);
    }
    outputs.push_back({{1, s.channels, s.rows, s.columns},
                       {static_cast<const float*>(floats.get_data_handle()), s.size()},
                       true});
    kept.push_back(floats);
  }

  void load(const Tensor& input) {
    // oneDNN only reads it, but a memory cannot say so.
    memory from({dims_of(shape(0)), Type::f32, memory::format_tag::nchw}, engine,
                const_cast<float*>(input.values.data()));
    dnnl::primitive_attr rounding;
    if (!map_steps.empty()) onednn::scale_outputs(rounding, 0, {1.0F / map_steps[0]});
    const dnnl::reorder::primitive_desc how(from, at(0), rounding);
    dnnl::reorder(how).execute(stream, from, at(0));
  }

  dnnl::engine engine{dnnl::engine::kind::cpu, 0};
  dnnl::stream stream{engine};
  Type narrow;
  std::vector<MapShape> shapes;  // by value
  std::vector<bool> wide;        // by value
  std::vector<float> map_steps;  // by value; empty unless maps are integers
  memory block;
  std::vector<memory> values;  // inside block
  std::vector<Step> steps;
  std::vector<Tensor> outputs;
  std::vector<memory> kept;                  // what outputs are views of
  std::vector<std::string> implementations;  // of the primitives, in the order of steps

 private:
  std::vector<memory> passing_;  // by turns in one of two blocks
  std::array<std::size_t, 2> passing_bytes_{};
  std::array<memory, 2> passing_block_;
};

OnednnPlan::OnednnPlan(const LayerGraph& graph, const std::vector<int>& input_shape,
                       const PlanOptions& options)
    : threads_(options.threads) {
  const OpenMpThreads limit(threads_);
  parts_ = std::make_unique<Parts>(graph, input_shape, options);
}

OnednnPlan::~OnednnPlan() = default;

std::vector<Tensor> OnednnPlan::run(const Tensor& input) {
  const OpenMpThreads limit(threads_);
  parts_->load(input);
  for (const Step& step : parts_->steps) step(parts_->stream);
  parts_->stream.wait();
  return parts_->outputs;
}

const std::vector<std::string>& OnednnPlan::implementations() const {
  return parts_->implementations;
}

bool onednn_has_kernels() {
  Layer layer;
  layer.activation = Activation::silu;
  layer.weights.dims = {16, 16, 3, 3};
  layer.window.kernel = {3, 3};
  layer.window.pad_begin = layer.window.pad_end = {1, 1};
  const memory::desc map({1, 16, 16, 16}, Type::f32, memory::format_tag::nhwc);
  const dnnl::engine engine(dnnl::engine::kind::cpu, 0);
  try {
    const ConvolutionKernel chosen = choose_convolution({layer, map, map, false}, engine);
    return is_compiled(chosen.kernel.impl_info_str());
  } catch (const std::exception&) {
    return false;
  }
}

bool onednn_has_int8() { return onednn::kHasFixedScales; }

#ifdef __x86_64__
bool onednn_has_bfloat16() { return __builtin_cpu_supports("avx512bw") != 0; }
#else
bool onednn_has_bfloat16() { return false; }
#endif

bool onednn_has_quick_bfloat16() {
  // Names of instruction sets are sets of bits: what came after AMX has its bits as well.
  const auto has = static_cast<unsigned>(dnnl::get_effective_cpu_isa());
  const auto amx = static_cast<unsigned>(dnnl::cpu_isa::avx512_core_amx);
  return onednn_has_bfloat16() && (has & amx) == amx;
}

}  // namespace ydd
#endif
