// SPDX-License-Identifier: Apache-2.0
// Networks in 8-bit integers against the same computed by plain loops, with the kernels that oneDNN
// has for each set of instructions (in a process of its own: onednn_plan_test.cc).
#if defined(YDD_WITH_ONEDNN) && defined(__x86_64__)
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <dnnl.hpp>

#include "ydd/base/files.h"
#include "ydd/inference/layer_shapes.h"
#include "ydd/inference/network_backends.h"
#include "ydd/inference/onednn_plan.h"
#include "ydd/inference/onednn_versions.h"
#include "ydd/inference/quantisation.h"
#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

using ::testing::HasSubstr;

/// Numbers of a map, channel by channel: integers in [-127, 127], or what an output is.
struct PlainMap {
  MapShape shape;
  std::vector<float> values;
  float& at(int c, int y, int x) {
    const std::size_t row = static_cast<std::size_t>(c) * static_cast<std::size_t>(shape.rows) +
                            static_cast<std::size_t>(y);
    return values[row * static_cast<std::size_t>(shape.columns) + static_cast<std::size_t>(x)];
  }
  bool has(int y, int x) const { return y >= 0 && y < shape.rows && x >= 0 && x < shape.columns; }
};

float activated(const Layer& layer, float x) {
  switch (layer.activation) {
    case Activation::silu:
      return x / (1 + std::exp(-x));
    case Activation::sigmoid:
      return 1 / (1 + std::exp(-x));
    case Activation::relu:
      return std::max(x, 0.0F);
    case Activation::leaky_relu:
      return x > 0 ? x : layer.slope * x;
    case Activation::none:
      break;
  }
  return x;
}

float rounded(float x) { return std::clamp(std::nearbyint(x), -128.0F, 127.0F); }

class PlainNetwork {
 public:
  PlainNetwork(const LayerGraph& graph, const std::vector<float>& ranges)
      : graph_(graph), steps_(value_steps(graph, wide_values(graph), ranges).value()) {}

  std::vector<PlainMap> run(const MapShape& shape, const std::vector<float>& input) {
    const std::vector<MapShape> shapes = map_shapes(graph_, shape);
    for (const MapShape& s : shapes) maps_.push_back({s, std::vector<float>(s.size())});
    for (std::size_t i = 0; i < input.size(); ++i) {
      maps_[0].values[i] = rounded(input[i] * (1.0F / steps_[0]));
    }
    for (const Layer& layer : graph_.layers) compute(layer);
    std::vector<PlainMap> out;
    for (const int o : graph_.outputs) out.push_back(map(o));
    return out;
  }

 private:
  PlainMap& map(int value) { return maps_[static_cast<std::size_t>(value)]; }
  float step(int value) const { return steps_[static_cast<std::size_t>(value)]; }

  void compute(const Layer& layer) {
    if (layer.kind == LayerKind::convolution) return convolve(layer);
    PlainMap& to = map(layer.output);
    int first = 0;
    for (const int input : layer.inputs) {
      PlainMap& from = map(input);
      const int channels =
          layer.kind == LayerKind::concat ? from.shape.channels : to.shape.channels;
      for (int c = 0; c < channels; ++c) {
        for (int y = 0; y < to.shape.rows; ++y) {
          for (int x = 0; x < to.shape.columns; ++x) {
            to.at(first + c, y, x) = layer.kind == LayerKind::concat ? from.at(c, y, x)
                                     : layer.kind == LayerKind::upsample
                                         ? from.at(c, y / layer.scale, x / layer.scale)
                                         : largest(layer, from, c, y, x);
          }
        }
      }
      first += channels;
    }
  }

  static float largest(const Layer& layer, PlainMap& from, int c, int y, int x) {
    const Window& w = layer.window;
    float most = -std::numeric_limits<float>::infinity();
    for (int i = 0; i < w.kernel[0]; ++i) {
      for (int j = 0; j < w.kernel[1]; ++j) {
        const int row = y * w.stride[0] - w.pad_begin[0] + i;
        const int column = x * w.stride[1] - w.pad_begin[1] + j;
        if (from.has(row, column)) most = std::max(most, from.at(c, row, column));
      }
    }
    return most;
  }

  void convolve(const Layer& layer) {
    const QuantisedWeights weights = quantise_weights(layer);
    PlainMap& from = map(layer.inputs[0]);
    PlainMap& to = map(layer.output);
    const Window& w = layer.window;
    const int fan_in = static_cast<int>(layer.weights.dims[1]);
    const int each = to.shape.channels / layer.groups;
    for (int c = 0; c < to.shape.channels; ++c) {
      for (int y = 0; y < to.shape.rows; ++y) {
        for (int x = 0; x < to.shape.columns; ++x) {
          int sum = 0;
          for (int k = 0; k < fan_in; ++k) {
            for (int i = 0; i < w.kernel[0]; ++i) {
              for (int j = 0; j < w.kernel[1]; ++j) {
                const int row = y * w.stride[0] - w.pad_begin[0] + i;
                const int column = x * w.stride[1] - w.pad_begin[1] + j;
                if (!from.has(row, column)) continue;
                const int at = ((c * fan_in + k) * w.kernel[0] + i) * w.kernel[1] + j;
                sum += weights.values[static_cast<std::size_t>(at)] *
                       static_cast<int>(from.at(c / each * fan_in + k, row, column));
              }
            }
          }
          const auto channel = static_cast<std::size_t>(c);
          const float real =
              static_cast<float>(sum) * step(layer.inputs[0]) * weights.steps[channel] +
              layer.bias.floats[channel];
          float result = activated(layer, real);
          if (layer.residual) result += map(*layer.residual).at(c, y, x) * step(*layer.residual);
          to.at(c, y, x) = step(layer.output) > 0 ? rounded(result / step(layer.output)) : result;
        }
      }
    }
  }

  const LayerGraph& graph_;
  std::vector<float> steps_;
  std::vector<PlainMap> maps_;
};

/// What a YOLO network does to maps, small: every activation, a residual, pooling, repetition.
std::string quantisable_model() {
  testing_onnx::GraphWriter g;
  const std::string stem = g.silu(g.convolution("images", 3, 16, 3, 2));
  const std::string left = g.silu(g.convolution(stem, 16, 16, 1));
  const std::string inner =
      g.silu(g.convolution(g.silu(g.convolution(left, 16, 16, 1)), 16, 16, 3));
  const std::string joined =
      g.concat({g.node("Add", {left, inner}), g.silu(g.convolution(stem, 16, 16, 1))});
  const std::string down = g.node("Relu", {g.convolution(joined, 32, 32, 3, 2)});
  const std::string pooled = g.silu(g.convolution(g.concat({down, g.pool(down, 5)}), 64, 16, 1));
  const std::string up = g.silu(g.convolution(g.concat({g.twice(pooled), joined}), 48, 16, 3));
  return g.finish(
      {g.node("Sigmoid", {g.convolution(up, 16, 24, 1)}), g.convolution(pooled, 16, 8, 1)});
}

LayerGraph quantisable_layers(const std::string& onnx) {
  return make_layers(read_onnx(onnx).value()).value();
}

std::size_t convolutions_of(const LayerGraph& graph) {
  return static_cast<std::size_t>(
      std::count_if(graph.layers.begin(), graph.layers.end(),
                    [](const Layer& layer) { return layer.kind == LayerKind::convolution; }));
}

std::vector<float> picture_of(int width, int height) {
  std::vector<float> input(static_cast<std::size_t>(3 * width * height));
  for (std::size_t i = 0; i < input.size(); ++i) {
    input[i] = static_cast<float>((i * 2654435761U) % 1000U) / 1000.0F;
  }
  return input;
}

struct Apart {
  float mean = 0, most = 0;
};

/// Of what a plan found from the reference.
Apart difference(const std::vector<Tensor>& found, std::vector<PlainMap>& expected) {
  Apart out;
  std::size_t count = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const MapShape& s = expected[k].shape;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const auto channels = static_cast<std::size_t>(s.channels);
      const float e = expected[k].values[(i % channels) * s.pixels() + i / channels];
      const float apart = std::abs(found[k].values[i] - e);
      out.most = std::max(out.most, apart);
      out.mean += apart;
    }
    count += s.size();
  }
  out.mean /= static_cast<float>(count);
  return out;
}

/// What this processor has of the instructions that are allowed: AVX2 with VNNI, for one, is
/// missing on many that have AVX-512 with VNNI.
bool multiplies_four_at_once() {
  switch (dnnl::get_effective_cpu_isa()) {
    case dnnl::cpu_isa::sse41:
    case dnnl::cpu_isa::avx:
    case dnnl::cpu_isa::avx2:
    case dnnl::cpu_isa::avx512_core:
      return false;
    default:
      return true;
  }
}

[[noreturn]] void check_int8(dnnl::cpu_isa isa) {
  std::string complaint;
  if (dnnl::set_max_cpu_isa(isa) != dnnl::status::success) complaint = "cannot force this";
  const LayerGraph graph = quantisable_layers(quantisable_model());
  const std::vector<float> ranges(convolutions_of(graph), 3.0F);
  const std::vector<float> picture = picture_of(64, 32);
  OnednnPlan plan(graph, {1, 3, 32, 64}, {MapNumbers::int8, 1, ranges});
  std::vector<PlainMap> expected = PlainNetwork(graph, ranges).run({3, 32, 64}, picture);
  // oneDNN's SiLU is right to a few units in the last place: a number that lies between two steps
  // may be rounded the other way, and one step is 0.024 here. Without VNNI oneDNN halves the
  // weights, so that the sums of two products fit into 16 bits: one bit of them is lost.
  const bool exact = multiplies_four_at_once();
  const Apart apart = difference(plan.run({{1, 3, 32, 64}, picture}), expected);
  OnednnPlan floats(graph, {1, 3, 32, 64}, {});
  const Apart from_floats = difference(floats.run({{1, 3, 32, 64}, picture}), expected);
  if (apart.mean > (exact ? 0.1F : 2.0F) * from_floats.mean || apart.most > 0.1F) {
    complaint += fmt::format("{} in the mean and {} at most from the reference; floats: {} and {}",
                             apart.mean, apart.most, from_floats.mean, from_floats.most);
  }
  std::fputs(complaint.c_str(), stderr);
  std::_Exit(complaint.empty() ? 0 : 1);
}

TEST(OnednnInt8, IsThePlainComputationWithEverySetOfInstructions) {
  if (!onednn_has_int8()) GTEST_SKIP() << "needs oneDNN 2";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const dnnl::cpu_isa isa : {dnnl::cpu_isa::avx2, dnnl::cpu_isa::avx2_vnni,
                                  dnnl::cpu_isa::avx512_core, onednn::kEveryIsa}) {
    EXPECT_EXIT(check_int8(isa), testing::ExitedWithCode(0), "") << static_cast<int>(isa);
  }
}

TEST(OnednnInt8, NeedsARangeForEachConvolutionAndNothingElseThatCalculates) {
  if (!onednn_has_int8()) GTEST_SKIP() << "needs oneDNN 2";
  const auto failure = [](const std::string& onnx, std::vector<float> ranges) {
    InferenceOptions options;
    options.precision = Precision::int8;
    options.ranges = std::move(ranges);
    const auto session = make_onednn_session(onnx, options);
    return session ? std::string("loaded") : session.error().message;
  };
  const std::string model = quantisable_model();
  const std::size_t count = convolutions_of(quantisable_layers(model));
  EXPECT_THAT(failure(model, {1.0F}), HasSubstr("for each of the 10 convolutions"));
  EXPECT_EQ(failure(model, std::vector<float>(count, 3.0F)), "loaded");
  std::vector<float> none(count, 3.0F);
  none[4] = 0;
  EXPECT_THAT(failure(model, none), HasSubstr("must be in [1e-6, 1e6]"));
  const std::string gated = testing_onnx::miniature_yolo_model();
  EXPECT_THAT(failure(gated, std::vector<float>(convolutions_of(quantisable_layers(gated)), 3.0F)),
              HasSubstr("calculate in their convolutions only"));
}

TEST(OnednnInt8, StepsAreSharedByWhatIsPutTogether) {
  const LayerGraph graph = quantisable_layers(quantisable_model());
  std::vector<float> ranges(convolutions_of(graph));
  for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i] = static_cast<float>(i + 1);
  const std::vector<float> steps = value_steps(graph, wide_values(graph), ranges).value();
  int together = 0;
  for (const Layer& layer : graph.layers) {
    if (layer.kind == LayerKind::convolution) continue;
    for (const int input : layer.inputs) {
      EXPECT_EQ(steps[static_cast<std::size_t>(input)],
                steps[static_cast<std::size_t>(layer.output)]);
      ++together;
    }
  }
  EXPECT_EQ(together, 8);
  for (const int output : graph.outputs) EXPECT_EQ(steps[static_cast<std::size_t>(output)], 0);
  EXPECT_FLOAT_EQ(steps[0], 1.0F / 127);
}

/// Each output channel uses all of the eight bits.
TEST(OnednnInt8, WeightsAreRoundedToHalfAStep) {
  const LayerGraph graph = quantisable_layers(quantisable_model());
  const Layer& layer = graph.layers.front();
  const QuantisedWeights q = quantise_weights(layer);
  const std::size_t each = q.values.size() / q.steps.size();
  for (std::size_t c = 0; c < q.steps.size(); ++c) {
    int largest = 0;
    for (std::size_t i = c * each; i < (c + 1) * each; ++i) {
      EXPECT_LE(std::abs(static_cast<float>(q.values[i]) * q.steps[c] - layer.weights.floats[i]),
                0.5001F * q.steps[c]);
      largest = std::max(largest, std::abs(static_cast<int>(q.values[i])));
    }
    EXPECT_EQ(largest, 127);
  }
}

}  // namespace
}  // namespace ydd
#endif
