// SPDX-License-Identifier: Apache-2.0
// What 8-bit integers would bring: every convolution of a network as it runs now (32-bit floats,
// the kernels of OnednnPlan) and as oneDNN would compute it from 8-bit maps and weights (a scale
// for each output channel, activation and sum in the same pass where it can, maps written as 8
// bits).
//
//   [ONEDNN_MAX_CPU_ISA=AVX2|AVX2_VNNI|AVX512_CORE|AVX512_CORE_VNNI] ydd_int8_bench
//       [models/ydd_n.onnx [416 320 [rounds]]]
//
// The forms run by turns, layer by layer, on one core; processor time, the median over the rounds,
// so that the ratios hold on a machine that does other work too.
#include <cstdio>

#ifdef YDD_WITH_ONEDNN
#include <dnnl.hpp>
#endif

#if defined(DNNL_VERSION_MAJOR) && DNNL_VERSION_MAJOR < 3
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <omp.h>

#include "ydd/base/files.h"
#include "ydd/inference/layer_shapes.h"
#include "ydd/inference/layers.h"
#include "ydd/inference/onednn_kernels.h"
#include "ydd/inference/onednn_plan.h"
#include "ydd/inference/onnx_graph.h"

namespace ydd {
namespace {

using dnnl::memory;
using Type = memory::data_type;
using Arguments = std::unordered_map<int, memory>;

double thread_cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> times) {
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

struct Steps {
  std::vector<std::pair<dnnl::primitive, Arguments>> steps;
  std::string implementation;
  std::vector<double> times_ms{};

  void run(dnnl::stream& stream) {
    const double start = thread_cpu_ms();
    for (auto& [primitive, arguments] : steps) primitive.execute(stream, arguments);
    times_ms.push_back(thread_cpu_ms() - start);
  }
};

memory::dims dims4(const MapShape& s) { return {1, s.channels, s.rows, s.columns}; }

/// Memory with small values in it: no denormal numbers, nothing that saturates.
memory filled(const memory::desc& desc, const dnnl::engine& engine) {
  memory held(desc, engine);
  const std::size_t bytes = desc.get_size();
  if (desc.data_type() == Type::f32) {
    auto* const values = static_cast<float*>(held.get_data_handle());
    for (std::size_t i = 0; i < bytes / sizeof(float); ++i) {
      values[i] = static_cast<float>((i * 2654435761U) % 1000U) / 1000.0F - 0.4F;
    }
  } else {
    auto* const values = static_cast<unsigned char*>(held.get_data_handle());
    for (std::size_t i = 0; i < bytes; ++i) {
      values[i] = static_cast<unsigned char>((i * 2654435761U) % 100U);
    }
  }
  return held;
}

void add_activation(Steps& steps, const Layer& layer, const memory& map,
                    const dnnl::engine& engine) {
  const auto chosen = choose_activation(layer, map.get_desc(), engine);
  steps.steps.emplace_back(dnnl::eltwise_forward(chosen),
                           Arguments{{DNNL_ARG_FROM, map}, {DNNL_ARG_TO, map}});
}

void add_sum(Steps& steps, const memory& map, const dnnl::engine& engine) {
  const auto sum = without_reference(
      dnnl::binary::primitive_desc(
          {dnnl::algorithm::binary_add, map.get_desc(), map.get_desc(), map.get_desc()}, engine),
      "a sum");
  steps.steps.emplace_back(
      dnnl::binary(sum),
      Arguments{{DNNL_ARG_SRC_0, map}, {DNNL_ARG_SRC_1, map}, {DNNL_ARG_DST, map}});
}

/// A convolution and what it leaves to other passes.
template <class Kernel>
Steps steps_of(const Layer& layer, const Kernel& kernel, bool activates, bool adds,
               const memory& scales, const dnnl::engine& engine) {
  const memory to = filled(kernel.dst_desc(), engine);
  Steps out{{}, kernel.impl_info_str()};
  Arguments arguments{
      {DNNL_ARG_SRC, filled(kernel.src_desc(), engine)},
      {DNNL_ARG_WEIGHTS, filled(kernel.weights_desc(), engine)},
      {DNNL_ARG_BIAS, filled({{layer.weights.dims[0]}, Type::f32, memory::format_tag::a}, engine)},
      {DNNL_ARG_DST, to}};
  if (scales) arguments.emplace(DNNL_ARG_ATTR_OUTPUT_SCALES, scales);
  out.steps.emplace_back(dnnl::convolution_forward(kernel), std::move(arguments));
  if (layer.activation != Activation::none && !activates) add_activation(out, layer, to, engine);
  if (layer.residual && !adds) add_sum(out, to, engine);
  return out;
}

Steps float_steps(const Layer& layer, const MapShape& from, const MapShape& to,
                  const dnnl::engine& engine) {
  const auto nhwc = memory::format_tag::nhwc;
  const ConvolutionKernel chosen = choose_convolution(
      {layer, {dims4(from), Type::f32, nhwc}, {dims4(to), Type::f32, nhwc}, false}, engine);
  return steps_of(layer, chosen.kernel, chosen.activates, chosen.adds, {}, engine);
}

std::optional<dnnl::convolution_forward::primitive_desc> ask_int8(
    const Layer& layer, const MapShape& from, const MapShape& to, Type source, Type result,
    bool activates, bool adds, const dnnl::engine& engine) {
  dnnl::post_ops after_it;
  if (activates && layer.activation == Activation::silu) {
    after_it.append_eltwise(1.0F, dnnl::algorithm::eltwise_swish, 1.0F, 0.0F);
  }
  if (activates && layer.activation == Activation::sigmoid) {
    after_it.append_eltwise(1.0F, dnnl::algorithm::eltwise_logistic, 0.0F, 0.0F);
  }
  if (adds) after_it.append_sum(0.5F);
  dnnl::primitive_attr attributes;
  attributes.set_post_ops(after_it);
  attributes.set_output_scales(
      1 << 1, std::vector<float>(static_cast<std::size_t>(layer.weights.dims[0]), 1e-4F));
  const dnnl::convolution_forward::desc form(
      dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct,
      {dims4(from), source, memory::format_tag::nhwc},
      {convolution_weight_dims(layer), Type::s8, memory::format_tag::any},
      {{layer.weights.dims[0]}, Type::f32, memory::format_tag::a},
      {dims4(to), result, memory::format_tag::nhwc}, dims_of(layer.window.stride),
      dims_of(layer.window.dilation, 1), dims_of(layer.window.pad_begin),
      dims_of(layer.window.pad_end));
  dnnl::convolution_forward::primitive_desc kernel(form, attributes, engine, /*allow_empty=*/true);
  while (kernel && is_reference(kernel.impl_info_str())) {
    if (!kernel.next_impl()) return std::nullopt;
  }
  return kernel ? std::optional(kernel) : std::nullopt;
}

/// Maps of 8 bits in and out; outputs of the network leave as floats, so that boxes keep their
/// bits.
std::optional<Steps> int8_steps(const Layer& layer, const MapShape& from, const MapShape& to,
                                Type map, bool output, const dnnl::engine& engine) {
  for (const auto& [activates, adds] :
       {std::pair{true, true}, std::pair{true, false}, std::pair{false, false}}) {
    if (!adds && activates && !layer.residual) continue;
    const auto kernel = ask_int8(layer, from, to, map, output ? Type::f32 : map, activates,
                                 adds && layer.residual, engine);
    if (kernel) return steps_of(layer, *kernel, activates, adds, {}, engine);
  }
  return std::nullopt;
}

struct Row {
  const Layer* layer;
  MapShape from, to;
  double operations;
  std::vector<Steps> forms;  // float, u8, s8
};

std::vector<Row> make_rows(const LayerGraph& graph, const std::vector<MapShape>& shapes,
                           const std::vector<bool>& wide, const dnnl::engine& engine) {
  std::vector<Row> rows;
  for (const Layer& layer : graph.layers) {
    if (layer.kind != LayerKind::convolution) continue;
    const MapShape from = shapes[static_cast<std::size_t>(layer.inputs[0])];
    const MapShape to = shapes[static_cast<std::size_t>(layer.output)];
    const bool output = wide[static_cast<std::size_t>(layer.output)];
    const auto& w = layer.weights.dims;
    Row row{&layer,
            from,
            to,
            2.0 * static_cast<double>(to.pixels()) * static_cast<double>(w[0] * w[1] * w[2] * w[3]),
            {}};
    row.forms.push_back(float_steps(layer, from, to, engine));
    for (const Type map : {Type::u8, Type::s8}) {
      // Without a kernel of 8 bits the layer stays as it is.
      row.forms.push_back(int8_steps(layer, from, to, map, output, engine).value_or(row.forms[0]));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void print(const std::vector<Row>& rows, double floats_ms, double int8_ms) {
  std::vector<double> sums(3, 0.0);
  std::map<std::string, int> kernels;
  std::printf("%-28s %7s %9s %6s %6s  kernels: float, 8 bits\n", "convolution", "Mop", "float ms",
              "u8", "s8");
  for (const Row& row : rows) {
    const auto& w = row.layer->weights.dims;
    char name[64];
    std::snprintf(name, sizeof name, "%dx%dx%d -> %d, %dx%d / %d", row.from.channels,
                  row.from.columns, row.from.rows, row.to.channels, static_cast<int>(w[2]),
                  static_cast<int>(w[3]), row.layer->window.stride[0]);
    std::vector<double> ms;
    for (std::size_t k = 0; k < 3; ++k) sums[k] += ms.emplace_back(median(row.forms[k].times_ms));
    std::printf("%-28s %7.1f %9.3f %6.2f %6.2f  %s, %s\n", name, row.operations / 1e6, ms[0],
                ms[1] / ms[0], ms[2] / ms[0], row.forms[0].implementation.c_str(),
                row.forms[1].implementation.c_str());
  }
  std::printf("\nconvolutions: float %.2f ms; u8 %.2f of it, s8 %.2f of it\n", sums[0],
              sums[1] / sums[0], sums[2] / sums[0]);
  std::printf("the whole network (OnednnPlan): float %.2f ms, 8 bits %.2f ms, %.2f of it\n",
              floats_ms, int8_ms, int8_ms / floats_ms);
}

int measure(const std::string& model, int width, int height, int rounds) {
  const Result<std::string> bytes = read_file(model);
  Result<OnnxGraph> read = bytes ? read_onnx(*bytes) : Result<OnnxGraph>(bytes.error());
  Result<LayerGraph> graph =
      read ? make_layers(std::move(*read)) : Result<LayerGraph>(read.error());
  if (!graph) {
    std::fprintf(stderr, "%s: %s\n", model.c_str(), graph.error().message.c_str());
    return 1;
  }
  omp_set_num_threads(1);
  const dnnl::engine engine(dnnl::engine::kind::cpu, 0);
  dnnl::stream stream(engine);
  std::vector<Row> rows =
      make_rows(*graph, map_shapes(*graph, {3, height, width}), wide_values(*graph), engine);
  const std::vector<float> ranges(rows.size(), 4.0F);
  OnednnPlan floats(*graph, {1, 3, height, width}, {});
  OnednnPlan int8(*graph, {1, 3, height, width}, {MapNumbers::int8, 1, ranges});
  const std::vector<float> picture(static_cast<std::size_t>(3) * static_cast<std::size_t>(height) *
                                       static_cast<std::size_t>(width),
                                   0.4F);
  std::vector<double> floats_ms, int8_ms;
  for (int i = 0; i < rounds; ++i) {
    for (std::size_t form = 0; form < 3; ++form) {
      for (Row& row : rows) row.forms[form].run(stream);
    }
    for (const auto& [plan, times] : {std::pair{&floats, &floats_ms}, std::pair{&int8, &int8_ms}}) {
      const double start = thread_cpu_ms();
      plan->run({{1, 3, height, width}, picture});
      times->push_back(thread_cpu_ms() - start);
    }
  }
  print(rows, median(floats_ms), median(int8_ms));
  return 0;
}

}  // namespace
}  // namespace ydd

int main(int argc, char** argv) {
  const auto number = [&](int k, int otherwise) {
    return argc > k ? std::max(1, std::atoi(argv[k])) : otherwise;
  };
  return ydd::measure(argc > 1 ? argv[1] : "models/ydd_n.onnx", number(2, 416), number(3, 320),
                      number(4, 51));
}
#else
int main() {
  std::puts("this build has no oneDNN 2 (Debian package libdnnl-dev)");
  return 0;
}
#endif
