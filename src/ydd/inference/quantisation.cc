// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/quantisation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <fmt/format.h>

namespace ydd {
namespace {

constexpr float kLargest = 127;  // -128 would have no counterpart

/// Values that must have one step.
class SameStep {
 public:
  explicit SameStep(int count) : parents_(static_cast<std::size_t>(count)) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }
  int first_of(int value) const {
    while (parents_[static_cast<std::size_t>(value)] != value) {
      value = parents_[static_cast<std::size_t>(value)];
    }
    return value;
  }
  void join(int a, int b) { parents_[static_cast<std::size_t>(first_of(a))] = first_of(b); }

 private:
  std::vector<int> parents_;
};

bool only_moves(LayerKind kind) {
  return kind == LayerKind::concat || kind == LayerKind::max_pool || kind == LayerKind::upsample;
}

Result<void> check_layers(const LayerGraph& graph, const std::vector<bool>& wide) {
  const auto floats = [&](int value) { return wide[static_cast<std::size_t>(value)]; };
  for (const Layer& layer : graph.layers) {
    const bool reads_floats = std::any_of(layer.inputs.begin(), layer.inputs.end(), floats);
    const bool moves = only_moves(layer.kind) && reads_floats == floats(layer.output);
    const bool convolves = layer.kind == LayerKind::convolution && !reads_floats;
    if (!moves && !convolves) {
      return Error{"precision int8 is for networks that calculate in their convolutions only"};
    }
  }
  if (!std::all_of(graph.outputs.begin(), graph.outputs.end(), floats)) {
    return Error{"precision int8 is for networks whose outputs come from convolutions"};
  }
  return {};
}

Result<void> check_ranges(const LayerGraph& graph, std::span<const float> ranges) {
  const auto convolutions =
      std::count_if(graph.layers.begin(), graph.layers.end(),
                    [](const Layer& layer) { return layer.kind == LayerKind::convolution; });
  if (static_cast<std::ptrdiff_t>(ranges.size()) != convolutions) {
    return Error{
        fmt::format("precision int8 needs a number in 'ranges' for each of the {} convolutions of "
                    "the network, not {} (training/detector/ranges.py measures them)",
                    convolutions, ranges.size())};
  }
  for (const float range : ranges) {
    if (!std::isfinite(range) || range < 1e-6F || range > 1e6F) {
      return Error{fmt::format("'ranges' has {}; each must be in [1e-6, 1e6]", range)};
    }
  }
  return {};
}

}  // namespace

Result<std::vector<float>> value_steps(const LayerGraph& graph, const std::vector<bool>& wide,
                                       std::span<const float> ranges) {
  if (auto sound = check_ranges(graph, ranges); !sound) return sound.error();
  if (auto simple = check_layers(graph, wide); !simple) return simple.error();
  SameStep same(graph.value_count);
  for (const Layer& layer : graph.layers) {
    if (!only_moves(layer.kind)) continue;
    for (const int input : layer.inputs) same.join(input, layer.output);
  }
  std::vector<float> largest(static_cast<std::size_t>(graph.value_count), 0.0F);
  std::size_t convolution = 0;
  for (const Layer& layer : graph.layers) {
    if (layer.kind != LayerKind::convolution) continue;
    float& range = largest[static_cast<std::size_t>(same.first_of(layer.inputs[0]))];
    range = std::max(range, ranges[convolution++]);
  }
  std::vector<float> steps;
  for (int v = 0; v < graph.value_count; ++v) {
    const float range = largest[static_cast<std::size_t>(same.first_of(v))];
    steps.push_back(wide[static_cast<std::size_t>(v)] ? 0.0F : range / kLargest);
  }
  return steps;
}

QuantisedWeights quantise_weights(const Layer& convolution) {
  const std::vector<float>& floats = convolution.weights.floats;
  const auto channels = static_cast<std::size_t>(convolution.weights.dims[0]);
  const std::size_t each = floats.size() / channels;
  QuantisedWeights out;
  out.values.reserve(floats.size());
  for (std::size_t c = 0; c < channels; ++c) {
    const std::span<const float> its(floats.data() + c * each, each);
    float largest = 0;
    for (const float w : its) largest = std::max(largest, std::abs(w));
    const float step = largest > 0 ? largest / kLargest : 1.0F;
    out.steps.push_back(step);
    for (const float w : its) {
      out.values.push_back(static_cast<std::int8_t>(std::lround(w / step)));
    }
  }
  return out;
}

}  // namespace ydd
