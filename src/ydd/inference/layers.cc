// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/layers.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/yaml_reader.h"

namespace ydd {
namespace {

using Ints = std::vector<std::int64_t>;

Error unsupported(const OnnxNode& node, const std::string& what) {
  return {fmt::format("operator {}{}", on_one_line(node.op), what)};
}

/// Both entries of a list of two.
std::array<int, 2> pair_of(const Ints& values, std::size_t first = 0) {
  return {static_cast<int>(values[first]), static_cast<int>(values[first + 1])};
}

Result<Window> window_of(const OnnxNode& node, const Ints& kernel) {
  const Ints strides = node.integers("strides", {1, 1});
  const Ints dilations = node.integers("dilations", {1, 1});
  const Ints pads = node.integers("pads", {0, 0, 0, 0});
  const std::string automatic = node.text("auto_pad", "NOTSET");
  if (kernel.size() != 2 || strides.size() != 2 || dilations.size() != 2 || pads.size() != 4) {
    return unsupported(node, " of other than two dimensions");
  }
  if (automatic != "NOTSET" && automatic != "VALID") return unsupported(node, " with auto_pad");
  if (node.integer("ceil_mode", 0) != 0) return unsupported(node, " with ceil_mode");
  for (const Ints* positive : {&kernel, &strides, &dilations}) {
    if (*std::min_element(positive->begin(), positive->end()) < 1) {
      return unsupported(node, " without extent");
    }
  }
  return Window{pair_of(kernel), pair_of(strides), pair_of(dilations), pair_of(pads),
                pair_of(pads, 2)};
}

/// Turns nodes into layers one by one; later nodes join earlier layers.
class Builder {
 public:
  explicit Builder(OnnxGraph graph) : graph_(std::move(graph)) {}

  Result<LayerGraph> build() {
    if (graph_.inputs.size() != 1) return Error{"has more than one input, or none"};
    value_of_[graph_.inputs[0]] = 0;
    for (const OnnxNode& node : graph_.nodes) {
      for (const std::string& input : node.inputs) ++readers_[input];
    }
    for (const std::string& output : graph_.outputs) ++readers_[output];
    for (const OnnxNode& node : graph_.nodes) {
      if (node.outputs.size() != 1) return unsupported(node, " with several outputs");
      if (auto added = add(node); !added) return added.error();
    }
    for (const std::string& output : graph_.outputs) {
      if (!value_of_.contains(output)) return Error{"has an output that nothing computes"};
      out_.outputs.push_back(value_of_[output]);
    }
    fuse_residuals();
    return std::move(out_);
  }

 private:
  Result<void> add(const OnnxNode& node) {
    if (node.op == "Conv") return add_convolution(node);
    if (node.op == "Sigmoid") return add_activation(node, Activation::sigmoid);
    if (node.op == "Relu") return add_activation(node, Activation::relu);
    if (node.op == "LeakyRelu") return add_activation(node, Activation::leaky_relu);
    if (node.op == "Add") return add_binary(node, LayerKind::add);
    if (node.op == "Mul") return add_product(node);
    if (node.op == "Concat") return add_concat(node);
    if (node.op == "MaxPool") return add_pool(node);
    if (node.op == "Resize") return add_upsample(node);
    return unsupported(node, " is not one of those");
  }

  Result<Layer> layer_of(const OnnxNode& node, LayerKind kind, std::size_t input_count) const {
    Layer layer;
    layer.kind = kind;
    for (std::size_t i = 0; i < input_count; ++i) {
      const auto found = i < node.inputs.size() ? value_of_.find(node.inputs[i]) : value_of_.end();
      if (found == value_of_.end()) return unsupported(node, " of constants");
      layer.inputs.push_back(found->second);
    }
    return layer;
  }

  Result<void> append(const OnnxNode& node, Result<Layer> layer) {
    if (!layer) return layer.error();
    layer->output = out_.value_count++;
    value_of_[node.outputs[0]] = layer->output;
    out_.layers.push_back(std::move(*layer));
    return {};
  }

  const OnnxTensor* constant(const OnnxNode& node, std::size_t input) const {
    if (input >= node.inputs.size()) return nullptr;
    const auto found = graph_.constants.find(node.inputs[input]);
    return found == graph_.constants.end() ? nullptr : &found->second;
  }

  Result<void> add_convolution(const OnnxNode& node) {
    Result<Layer> layer = layer_of(node, LayerKind::convolution, 1);
    if (!layer) return layer.error();
    const OnnxTensor* weights = constant(node, 1);
    if (weights == nullptr || weights->dims.size() != 4 || weights->floats.empty()) {
      return unsupported(node, " without constant weights");
    }
    const Ints kernel{weights->dims[2], weights->dims[3]};
    const Result<Window> window = window_of(node, kernel);
    if (!window) return window.error();
    layer->window = *window;
    layer->groups = static_cast<int>(node.integer("group", 1));
    layer->weights = *weights;
    if (node.inputs.size() > 2 && !node.inputs[2].empty()) {
      const OnnxTensor* bias = constant(node, 2);
      if (bias == nullptr || bias->floats.size() != static_cast<std::size_t>(weights->dims[0])) {
        return unsupported(node, " without constant bias");
      }
      layer->bias = *bias;
    }
    if (layer->groups < 1 || weights->dims[0] % layer->groups != 0) {
      return unsupported(node, " whose groups do not fit");
    }
    return append(node, std::move(layer));
  }

  /// The layer that computes `value` for one reader only, or null.
  Layer* sole_source(const std::string& value) {
    const auto number = value_of_.find(value);
    if (number == value_of_.end() || readers_[value] != 1) return nullptr;
    return source(number->second);
  }

  Layer* source(int value) {
    const auto found = std::find_if(out_.layers.begin(), out_.layers.end(),
                                    [&](const Layer& layer) { return layer.output == value; });
    return found == out_.layers.end() ? nullptr : &*found;
  }

  static bool takes_activation(const Layer* layer) {
    return layer != nullptr && layer->kind == LayerKind::convolution &&
           layer->activation == Activation::none;
  }

  Result<void> add_activation(const OnnxNode& node, Activation activation) {
    Result<Layer> layer = layer_of(node, LayerKind::activation, 1);
    if (!layer) return layer.error();
    const float slope = node.number("alpha", 0.01F);
    if (Layer* before = sole_source(node.inputs[0]); takes_activation(before)) {
      before->activation = activation;
      before->slope = slope;
      value_of_[node.outputs[0]] = before->output;
      return {};
    }
    layer->activation = activation;
    layer->slope = slope;
    return append(node, std::move(layer));
  }

  /// x * sigmoid(x) becomes the activation silu; both orders occur.
  Result<void> add_product(const OnnxNode& node) {
    Result<Layer> product = layer_of(node, LayerKind::multiply, 2);
    if (!product) return product.error();
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      Layer* gate = sole_source(node.inputs[side]);
      const int x = product->inputs[1 - side];
      if (gate == nullptr || gate->kind != LayerKind::activation ||
          gate->activation != Activation::sigmoid || gate->inputs[0] != x) {
        continue;
      }
      Layer* before = source(x);
      if (takes_activation(before) && readers_[node.inputs[1 - side]] == 2) {
        before->activation = Activation::silu;
        value_of_[node.outputs[0]] = x;
        const int gone = gate->output;
        std::erase_if(out_.layers, [&](const Layer& layer) { return layer.output == gone; });
      } else {
        gate->activation = Activation::silu;
        value_of_[node.outputs[0]] = gate->output;
      }
      return {};
    }
    return append(node, std::move(product));
  }

  Result<void> add_binary(const OnnxNode& node, LayerKind kind) {
    return append(node, layer_of(node, kind, 2));
  }

  Result<void> add_concat(const OnnxNode& node) {
    if (node.integer("axis", 0) != 1) return unsupported(node, " along another axis than channels");
    return append(node, layer_of(node, LayerKind::concat, node.inputs.size()));
  }

  Result<void> add_pool(const OnnxNode& node) {
    Result<Layer> layer = layer_of(node, LayerKind::max_pool, 1);
    if (!layer) return layer.error();
    const Result<Window> window = window_of(node, node.integers("kernel_shape", {}));
    if (!window) return window.error();
    if (window->dilation != std::array<int, 2>{1, 1}) return unsupported(node, " with dilation");
    layer->window = *window;
    return append(node, std::move(layer));
  }

  /// Nearest neighbour by a whole factor: repetition.
  Result<void> add_upsample(const OnnxNode& node) {
    Result<Layer> layer = layer_of(node, LayerKind::upsample, 1);
    if (!layer) return layer.error();
    const OnnxTensor* scales = constant(node, 2);
    const std::string where = node.text("coordinate_transformation_mode", "half_pixel");
    const bool floors = node.text("nearest_mode", "round_prefer_floor") == "floor";
    const bool repeats = node.text("mode", "nearest") == "nearest" &&
                         ((where == "asymmetric" && floors) || (where == "half_pixel" && !floors));
    if (!repeats || scales == nullptr || scales->floats.size() != 4) {
      return unsupported(node, " that is not a repetition by a constant factor");
    }
    const std::vector<float>& s = scales->floats;
    layer->scale = static_cast<int>(s[2]);
    if (s[0] != 1 || s[1] != 1 || s[2] != s[3] || layer->scale < 1 ||
        static_cast<float>(layer->scale) != s[2]) {
      return unsupported(node, " by a factor that is not whole");
    }
    return append(node, std::move(layer));
  }

  /// conv -> add(x, conv) becomes conv that adds to x in place, when nobody needs x later.
  void fuse_residuals() {
    const std::vector<int> last = last_uses(out_);
    std::vector<int> uses(static_cast<std::size_t>(out_.value_count), 0);
    for (const Layer& layer : out_.layers) {
      for (const int input : layer.inputs) ++uses[static_cast<std::size_t>(input)];
    }
    for (std::size_t i = 0; i < out_.layers.size(); ++i) {
      Layer& sum = out_.layers[i];
      if (sum.kind != LayerKind::add) continue;
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        const int x = sum.inputs[1 - side];
        Layer* before = source(sum.inputs[side]);
        if (before == nullptr || before->kind != LayerKind::convolution || before->residual ||
            uses[static_cast<std::size_t>(sum.inputs[side])] != 1 ||
            last[static_cast<std::size_t>(sum.inputs[side])] != static_cast<int>(i) ||
            last[static_cast<std::size_t>(x)] != static_cast<int>(i) || x == 0 ||
            x == sum.inputs[side] || !idle_between(x, *before, sum)) {
          continue;
        }
        before->residual = x;
        before->output = sum.output;
        sum.inputs.clear();  // marks it as done
        break;
      }
    }
    std::erase_if(out_.layers, [](const Layer& layer) { return layer.inputs.empty(); });
  }

  /// Whether `value` exists before `first`, and nobody reads it between both.
  bool idle_between(int value, const Layer& first, const Layer& second) {
    const Layer* its = source(value);
    if (its == nullptr || its >= &first) return false;
    return std::none_of(&first, &second, [&](const Layer& layer) {
      return layer.residual == value ||
             std::find(layer.inputs.begin(), layer.inputs.end(), value) != layer.inputs.end();
    });
  }

  OnnxGraph graph_;
  LayerGraph out_;
  std::map<std::string, int> value_of_;
  std::map<std::string, int> readers_;
};

}  // namespace

std::vector<int> last_uses(const LayerGraph& graph) {
  std::vector<int> last(static_cast<std::size_t>(graph.value_count), -1);
  for (std::size_t i = 0; i < graph.layers.size(); ++i) {
    for (const int input : graph.layers[i].inputs) {
      last[static_cast<std::size_t>(input)] = static_cast<int>(i);
    }
    if (const auto& x = graph.layers[i].residual) {
      last[static_cast<std::size_t>(*x)] = static_cast<int>(i);
    }
  }
  for (const int output : graph.outputs) {
    last[static_cast<std::size_t>(output)] = static_cast<int>(graph.layers.size());
  }
  return last;
}

Result<LayerGraph> make_layers(OnnxGraph graph) { return Builder(std::move(graph)).build(); }

}  // namespace ydd
