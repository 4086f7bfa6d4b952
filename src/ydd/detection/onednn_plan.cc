// SPDX-License-Identifier: Apache-2.0
#ifdef YDD_WITH_ONEDNN
#include "ydd/detection/onednn_plan.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include <omp.h>
#include <dnnl.hpp>

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

struct MapShape {
  int channels = 0, rows = 0, columns = 0;
  memory::dims dims() const { return {1, channels, rows, columns}; }
  std::size_t size() const {
    return static_cast<std::size_t>(channels) * static_cast<std::size_t>(rows) *
           static_cast<std::size_t>(columns);
  }
  friend bool operator==(const MapShape&, const MapShape&) = default;
};

int windowed(int size, const Window& w, std::size_t axis) {
  const int reach = (w.kernel[axis] - 1) * w.dilation[axis] + 1;
  const int room = size + w.pad_begin[axis] + w.pad_end[axis] - reach;
  if (room < 0) throw std::runtime_error("it is smaller than a window of the network");
  return room / w.stride[axis] + 1;
}

MapShape after_concat(const std::vector<MapShape>& inputs) {
  MapShape out = inputs.front();
  out.channels = 0;
  for (const MapShape& s : inputs) {
    if (s.rows != out.rows || s.columns != out.columns) {
      throw std::runtime_error("maps of different sizes would have to be put together");
    }
    out.channels += s.channels;
  }
  return out;
}

MapShape after(const Layer& layer, const std::vector<MapShape>& inputs) {
  MapShape out = inputs.front();
  switch (layer.kind) {
    case LayerKind::convolution:
      if (layer.weights.dims[1] * layer.groups != out.channels) {
        throw std::runtime_error("the channels do not fit the network");
      }
      out.channels = static_cast<int>(layer.weights.dims[0]);
      [[fallthrough]];
    case LayerKind::max_pool:
      return {out.channels, windowed(out.rows, layer.window, 0),
              windowed(out.columns, layer.window, 1)};
    case LayerKind::upsample:
      return {out.channels, out.rows * layer.scale, out.columns * layer.scale};
    case LayerKind::concat:
      return after_concat(inputs);
    case LayerKind::add:
    case LayerKind::multiply:
      if (inputs[0] != inputs[1])
        throw std::runtime_error("maps of different sizes would be joined");
      return out;
    case LayerKind::activation:
      return out;
  }
  throw std::logic_error("OnednnPlan: not a LayerKind");
}

/// Places in one block of memory for values that live from one layer to another.
class Arena {
 public:
  std::size_t take(std::size_t size) {
    constexpr std::size_t kLine = 64;
    size = (size + kLine - 1) / kLine * kLine;
    std::size_t offset = 0;
    auto at = live_.begin();
    for (; at != live_.end() && at->offset < offset + size; ++at) offset = at->offset + at->size;
    live_.insert(at, {offset, size});
    size_ = std::max(size_, offset + size);
    return offset;
  }
  void give_back(std::size_t offset) {
    std::erase_if(live_, [&](const Block& b) { return b.offset == offset; });
  }
  std::size_t size() const { return size_; }

 private:
  struct Block {
    std::size_t offset, size;
  };
  std::vector<Block> live_;  // by offset
  std::size_t size_ = 0;
};

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

memory::dims dims_of(const std::array<int, 2>& pair, int less = 0) {
  return {pair[0] - less, pair[1] - less};
}

/// Which values are 32-bit floats although the others are not: outputs, and what is only put
/// together into one, so that boxes do not lose the last bits.
std::vector<bool> wide_values(const LayerGraph& graph) {
  std::vector<bool> wide(static_cast<std::size_t>(graph.value_count), false);
  std::vector<int> readers(static_cast<std::size_t>(graph.value_count), 0);
  std::vector<bool> convolved(static_cast<std::size_t>(graph.value_count), false);
  for (const Layer& layer : graph.layers) {
    for (const int input : layer.inputs) ++readers[static_cast<std::size_t>(input)];
    convolved[static_cast<std::size_t>(layer.output)] =
        layer.kind == LayerKind::convolution && !layer.residual;
  }
  const auto may_be = [&](int value) {
    return convolved[static_cast<std::size_t>(value)] &&
           readers[static_cast<std::size_t>(value)] <= 1;
  };
  for (const int output : graph.outputs) {
    const auto its = std::find_if(graph.layers.begin(), graph.layers.end(),
                                  [&](const Layer& layer) { return layer.output == output; });
    if (its == graph.layers.end() || readers[static_cast<std::size_t>(output)] > 0) continue;
    if (its->kind == LayerKind::concat &&
        std::all_of(its->inputs.begin(), its->inputs.end(), may_be)) {
      for (const int input : its->inputs) wide[static_cast<std::size_t>(input)] = true;
      wide[static_cast<std::size_t>(output)] = true;
    }
    if (may_be(output)) wide[static_cast<std::size_t>(output)] = true;
  }
  return wide;
}

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
  Parts(const LayerGraph& graph, const std::vector<int>& input_shape, bool bfloat16)
      : narrow(bfloat16 ? Type::bf16 : Type::f32) {
    if (input_shape.size() != 4 || input_shape[0] != 1) {
      throw std::runtime_error("the network takes one picture at a time");
    }
    find_shapes(graph, {input_shape[1], input_shape[2], input_shape[3]});
    wide = wide_values(graph);
    place_values(graph);
    for (const Layer& layer : graph.layers) add_step(layer);
    for (const int output : graph.outputs) add_output(output);
  }

  const MapShape& shape(int value) const { return shapes[static_cast<std::size_t>(value)]; }
  Type type(int value) const { return wide[static_cast<std::size_t>(value)] ? Type::f32 : narrow; }
  std::size_t pixel_bytes(int value) const {
    return static_cast<std::size_t>(shape(value).channels) * memory::data_type_size(type(value));
  }
  std::size_t pixels(int value) const {
    return static_cast<std::size_t>(shape(value).rows) *
           static_cast<std::size_t>(shape(value).columns);
  }
  memory::desc description(int value) const {
    return {shape(value).dims(), type(value), memory::format_tag::nhwc};
  }
  memory& at(int value) { return values[static_cast<std::size_t>(value)]; }

  void find_shapes(const LayerGraph& graph, const MapShape& input) {
    shapes.resize(static_cast<std::size_t>(graph.value_count));
    shapes[0] = input;
    for (const Layer& layer : graph.layers) {
      std::vector<MapShape> inputs;
      for (const int value : layer.inputs) inputs.push_back(shape(value));
      MapShape out = after(layer, inputs);
      if (layer.residual && shape(*layer.residual) != out) {
        throw std::runtime_error("maps of different sizes would be added");
      }
      shapes[static_cast<std::size_t>(layer.output)] = out;
    }
  }

  void place_values(const LayerGraph& graph) {
    const std::vector<int> last = last_uses(graph);
    std::vector<std::size_t> offsets(shapes.size(), 0);
    Arena arena;
    const auto place = [&](int value) {
      offsets[static_cast<std::size_t>(value)] = arena.take(pixel_bytes(value) * pixels(value));
    };
    place(0);
    for (int i = 0; i < static_cast<int>(graph.layers.size()); ++i) {
      const Layer& layer = graph.layers[static_cast<std::size_t>(i)];
      if (layer.residual) {  // computed where the other part of the sum lies
        offsets[static_cast<std::size_t>(layer.output)] =
            offsets[static_cast<std::size_t>(*layer.residual)];
      } else {
        place(layer.output);
      }
      std::vector<int> done = layer.inputs;
      std::sort(done.begin(), done.end());
      done.erase(std::unique(done.begin(), done.end()), done.end());
      for (const int value : done) {
        if (last[static_cast<std::size_t>(value)] == i) {
          arena.give_back(offsets[static_cast<std::size_t>(value)]);
        }
      }
    }
    block =
        memory({{static_cast<memory::dim>(arena.size())}, Type::u8, memory::format_tag::a}, engine);
    auto* const start = static_cast<std::byte*>(block.get_data_handle());
    for (int v = 0; v < graph.value_count; ++v) {
      if (shape(v).channels == 0) {  // fused away
        values.emplace_back();
      } else {
        values.emplace_back(description(v), engine, start + offsets[static_cast<std::size_t>(v)]);
      }
    }
  }

  void add_step(const Layer& layer) {
    switch (layer.kind) {
      case LayerKind::convolution:
        return add_convolution(layer);
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

  void add_primitive(const dnnl::primitive& primitive, Arguments arguments) {
    steps.emplace_back([primitive, arguments = std::move(arguments)](dnnl::stream& on) {
      primitive.execute(on, arguments);
    });
  }

  /// `from` as a kernel wants it; once for constants, in each run for feature maps.
  memory reordered(memory from, const memory::desc& wanted, bool once) {
    if (from.get_desc() == wanted) return from;
    memory to(wanted, engine);
    if (once) {
      dnnl::reorder(from, to).execute(stream, from, to);
      stream.wait();
    } else {
      add_primitive(dnnl::reorder(from, to), {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
    }
    return to;
  }

  memory constant(const OnnxTensor& tensor, const memory::dims& dims, memory::format_tag tag) {
    memory held({dims, Type::f32, tag}, engine);
    std::memcpy(held.get_data_handle(), tensor.floats.data(), tensor.floats.size() * sizeof(float));
    return held;
  }

  static dnnl::primitive_attr attributes_of(const Layer& layer) {
    dnnl::post_ops after_it;
    if (layer.activation != Activation::none) {
      after_it.append_eltwise(1.0F, algorithm_of(layer.activation), alpha_of(layer), 0.0F);
    }
    if (layer.residual) after_it.append_sum(1.0F);
    dnnl::primitive_attr attributes;
    attributes.set_post_ops(after_it);
    return attributes;
  }

  void add_convolution(const Layer& layer) {
    using Convolution = dnnl::convolution_forward;
    const memory::dims& w = layer.weights.dims;
    const memory::dim groups = layer.groups;
    const memory::dims weight_dims =
        groups == 1 ? w : memory::dims{groups, w[0] / groups, w[1], w[2], w[3]};
    OnnxTensor bias = layer.bias;
    if (bias.floats.empty()) bias.floats.assign(static_cast<std::size_t>(w[0]), 0.0F);
    const int input = layer.inputs[0];
    // Three channels have a kernel of their own, that says how it wants them.
    const auto input_tag = input == 0 ? memory::format_tag::any : memory::format_tag::nhwc;
    const Convolution::primitive_desc chosen({dnnl::prop_kind::forward_inference,
                                              dnnl::algorithm::convolution_direct,
                                              {shape(input).dims(), narrow, input_tag},
                                              {weight_dims, narrow, memory::format_tag::any},
                                              {{w[0]}, Type::f32, memory::format_tag::a},
                                              description(layer.output),
                                              dims_of(layer.window.stride),
                                              dims_of(layer.window.dilation, 1),
                                              dims_of(layer.window.pad_begin),
                                              dims_of(layer.window.pad_end)},
                                             attributes_of(layer), engine);
    const auto plain = groups == 1 ? memory::format_tag::oihw : memory::format_tag::goihw;
    const memory from = reordered(at(input), chosen.src_desc(), false);
    memory weights =
        reordered(constant(layer.weights, weight_dims, plain), chosen.weights_desc(), true);
    add_primitive(Convolution(chosen),
                  {{DNNL_ARG_SRC, from},
                   {DNNL_ARG_WEIGHTS, weights},
                   {DNNL_ARG_BIAS, constant(bias, {w[0]}, memory::format_tag::a)},
                   {DNNL_ARG_DST, at(layer.output)}});
  }

  void add_pool(const Layer& layer) {
    const int input = layer.inputs[0];
    const dnnl::pooling_forward::primitive_desc chosen(
        {dnnl::prop_kind::forward_inference, dnnl::algorithm::pooling_max, description(input),
         description(layer.output), dims_of(layer.window.stride), dims_of(layer.window.kernel),
         dims_of(layer.window.pad_begin), dims_of(layer.window.pad_end)},
        engine);
    add_primitive(dnnl::pooling_forward(chosen),
                  {{DNNL_ARG_SRC, at(input)}, {DNNL_ARG_DST, at(layer.output)}});
  }

  void add_activation(const Layer& layer) {
    const dnnl::eltwise_forward::primitive_desc chosen(
        {dnnl::prop_kind::forward_inference, algorithm_of(layer.activation),
         description(layer.inputs[0]), alpha_of(layer), 0.0F},
        engine);
    const memory from = reordered(at(layer.inputs[0]), chosen.src_desc(), false);
    const memory there = reordered_place(layer.output, chosen.dst_desc());
    add_primitive(dnnl::eltwise_forward(chosen), {{DNNL_ARG_SRC, from}, {DNNL_ARG_DST, there}});
  }

  memory reordered_place(int value, const memory::desc& wanted) {
    if (wanted != description(value)) throw std::runtime_error("no kernel for an activation");
    return at(value);
  }

  void add_binary(const Layer& layer, dnnl::algorithm algorithm) {
    const dnnl::binary::primitive_desc chosen(
        {algorithm, description(layer.inputs[0]), description(layer.inputs[1]),
         description(layer.output)},
        engine);
    add_primitive(dnnl::binary(chosen), {{DNNL_ARG_SRC_0, at(layer.inputs[0])},
                                         {DNNL_ARG_SRC_1, at(layer.inputs[1])},
                                         {DNNL_ARG_DST, at(layer.output)}});
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
    const memory floats =
        reordered(at(value), {s.dims(), Type::f32, memory::format_tag::nhwc}, false);
    outputs.push_back({{1, s.channels, s.rows, s.columns},
                       {static_cast<const float*>(floats.get_data_handle()), s.size()},
                       true});
    kept.push_back(floats);
  }

  void load(const Tensor& input) {
    // oneDNN only reads it, but a memory cannot say so.
    memory from({shape(0).dims(), Type::f32, memory::format_tag::nchw}, engine,
                const_cast<float*>(input.values.data()));
    dnnl::reorder(from, at(0)).execute(stream, from, at(0));
  }

  dnnl::engine engine{dnnl::engine::kind::cpu, 0};
  dnnl::stream stream{engine};
  Type narrow;
  std::vector<MapShape> shapes;  // by value
  std::vector<bool> wide;        // by value
  memory block;
  std::vector<memory> values;  // inside block
  std::vector<Step> steps;
  std::vector<Tensor> outputs;
  std::vector<memory> kept;  // what outputs are views of
};

OnednnPlan::OnednnPlan(const LayerGraph& graph, const std::vector<int>& input_shape, bool bfloat16,
                       int threads)
    : threads_(threads) {
  const OpenMpThreads limit(threads);
  parts_ = std::make_unique<Parts>(graph, input_shape, bfloat16);
}

OnednnPlan::~OnednnPlan() = default;

std::vector<Tensor> OnednnPlan::run(const Tensor& input) {
  const OpenMpThreads limit(threads_);
  parts_->load(input);
  for (const Step& step : parts_->steps) step(parts_->stream);
  parts_->stream.wait();
  return parts_->outputs;
}

bool onednn_is_quick_here() {
  const auto isa = dnnl::get_effective_cpu_isa();
  return isa != dnnl::cpu_isa::all && isa != dnnl::cpu_isa::sse41 && isa != dnnl::cpu_isa::avx;
}

bool onednn_has_bfloat16() { return __builtin_cpu_supports("avx512bw") != 0; }

bool onednn_has_quick_bfloat16() {
  return dnnl::get_effective_cpu_isa() == dnnl::cpu_isa::avx512_core_amx;
}

}  // namespace ydd
#endif
