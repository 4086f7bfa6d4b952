// SPDX-License-Identifier: Apache-2.0
// What a network may say, told once where its file is read: OpenCV and oneDNN believe it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "ydd/base/yaml_reader.h"
#include "ydd/inference/onnx_graph.h"

namespace ydd {
namespace {

using Names = std::set<std::string, std::less<>>;

constexpr std::size_t kMostNodes = 20'000;
constexpr std::size_t kMostOfANode = 1024;  // inputs, outputs, numbers of an attribute

/// The least and the largest that an attribute may hold, by name; generous against any network
/// that looks at pictures.
struct AttributeRange {
  std::string_view name;
  std::int64_t least, most;
  std::size_t at_least_this_many = 0;
};
constexpr std::int64_t kLongestWindow = 4096;
constexpr std::array<AttributeRange, 22> kRanges = {{{"kernel_shape", 1, kLongestWindow, 1},
                                                     {"strides", 1, kLongestWindow, 1},
                                                     {"dilations", 1, kLongestWindow, 1},
                                                     {"pads", -kLongestWindow, kLongestWindow, 2},
                                                     {"output_padding", 0, kLongestWindow, 1},
                                                     {"output_shape", 1, 1 << 16, 1},
                                                     {"group", 1, 1 << 16, 1},
                                                     {"axis", -8, 7, 1},
                                                     {"axes", -8, 7},
                                                     {"perm", 0, 7, 1},
                                                     {"batch_axis", -8, 7, 1},
                                                     {"time_axis", -8, 7, 1},
                                                     {"batch_dims", 0, 7, 1},
                                                     {"blocksize", 1, 1024, 1},
                                                     {"split", 0, kMostNumbers},
                                                     {"shape", -1, kMostNumbers},
                                                     {"num_outputs", 1, 1024, 1},
                                                     {"hidden_size", 1, 1 << 16, 1},
                                                     {"size", 1, 1 << 16, 1},
                                                     {"to", 0, 64, 1},
                                                     {"output_height", 1, 1 << 16, 1},
                                                     {"output_width", 1, 1 << 16, 1}}};

/// Fewest inputs that an operator can do its work with; those that are not named need one.
struct InputNeed {
  std::string_view op;
  std::size_t inputs;
};
constexpr std::array<InputNeed, 26> kNeeds = {
    {{"Conv", 2},     {"ConvTranspose", 2}, {"Gemm", 2},   {"MatMul", 2},
     {"Add", 2},      {"Sub", 2},           {"Mul", 2},    {"Div", 2},
     {"Pow", 2},      {"PRelu", 2},         {"Gather", 2}, {"Expand", 2},
     {"Tile", 2},     {"Where", 3},         {"Equal", 2},  {"Greater", 2},
     {"Less", 2},     {"And", 2},           {"Or", 2},     {"BatchNormalization", 5},
     {"LSTM", 3},     {"GRU", 3},           {"RNN", 3},    {"InstanceNormalization", 3},
     {"GatherND", 2}, {"ScatterND", 3}}};
constexpr std::array<std::string_view, 5> kSources = {"Constant", "RandomNormal", "RandomUniform",
                                                      "If", "Loop"};

std::size_t needed_inputs(const OnnxNode& node) {
  for (const InputNeed& need : kNeeds) {
    if (need.op == node.op) return need.inputs;
  }
  const bool is_source = std::find(kSources.begin(), kSources.end(), node.op) != kSources.end();
  return is_source ? 0 : 1;
}

Result<void> check_form(const OnnxNode& node) {
  if (node.op.empty()) return Error{"damaged: an operator without a name"};
  if (node.outputs.empty() || node.outputs.front().empty()) {
    return Error{fmt::format("damaged: {} gives nothing", describe(node))};
  }
  if (node.inputs.size() > kMostOfANode || node.outputs.size() > kMostOfANode) {
    return Error{fmt::format("{} has too many inputs or outputs", describe(node))};
  }
  const std::size_t needed = needed_inputs(node);
  for (std::size_t i = 0; i < needed; ++i) {
    if (i < node.inputs.size() && !node.inputs[i].empty()) continue;
    return Error{fmt::format("damaged: {} lacks an input: it needs {}", describe(node), needed)};
  }
  return {};
}

Result<void> check_range(const OnnxNode& node, std::string_view name, const OnnxAttribute& a) {
  const auto range = std::find_if(kRanges.begin(), kRanges.end(),
                                  [&](const AttributeRange& r) { return r.name == name; });
  const bool is_known = range != kRanges.end();
  // Slices end at the largest number there is.
  const bool is_free = name == "starts" || name == "ends" || name.starts_with("value");
  if (is_free) return {};
  std::int64_t least = is_known ? range->least : std::numeric_limits<std::int32_t>::min();
  if (name == "pads" && node.op != "Pad") least = 0;
  const std::int64_t most = is_known ? range->most : std::numeric_limits<std::int32_t>::max();
  for (const std::int64_t v : a.integers) {
    if (v >= least && v <= most) continue;
    return Error{fmt::format("{}: '{}' holds {}, but can only be {} to {}", describe(node), name, v,
                             least, most)};
  }
  if (is_known && a.integers.size() < range->at_least_this_many) {
    return Error{fmt::format("{}: '{}' holds too few numbers", describe(node), name)};
  }
  return {};
}

Result<void> check_permutation(const OnnxNode& node) {
  std::vector<std::int64_t> perm = node.integers("perm", {});
  std::sort(perm.begin(), perm.end());
  for (std::size_t i = 0; i < perm.size(); ++i) {
    if (perm[i] == static_cast<std::int64_t>(i)) continue;
    return Error{fmt::format("{}: 'perm' is no order of dimensions", describe(node))};
  }
  return {};
}

Result<void> check_scales(const OnnxNode& node, const std::vector<float>& scales) {
  constexpr float kMost = 64;
  for (const float s : scales) {
    if (std::isfinite(s) && s > 0 && s <= kMost) continue;
    return Error{fmt::format("{}: its scales hold {}, but can only be above 0 and at most {}",
                             describe(node), s, kMost)};
  }
  return {};
}

/// Sizes that come as constants instead of attributes.
Result<void> check_constants(const OnnxNode& node, const OnnxGraph& graph) {
  if (node.op != "Resize" && node.op != "Upsample") return {};
  for (const std::string& input : node.inputs) {
    const auto found = graph.constants.find(input);
    if (found == graph.constants.end()) continue;
    const bool is_region =
        node.op == "Resize" && &input == &node.inputs[1] && node.inputs.size() > 2;  // roi
    if (!is_region) {
      if (auto r = check_scales(node, found->second.floats); !r) return r;
    }
    for (const std::int64_t size : found->second.integers) {
      if (size >= 1 && size <= 1 << 16) continue;
      return Error{fmt::format("{}: a size of {} is asked for", describe(node), size)};
    }
  }
  return {};
}

Result<void> check_node(const OnnxNode& node, const OnnxGraph& graph) {
  for (const auto& [name, attribute] : node.attributes) {
    if (std::max(attribute.integers.size(), attribute.floats.size()) > kMostOfANode &&
        !name.starts_with("value")) {
      return Error{
          fmt::format("{}: '{}' holds too many numbers", describe(node), on_one_line(name))};
    }
    if (auto r = check_range(node, name, attribute); !r) return r;
    if (name == "scales") {
      if (auto r = check_scales(node, attribute.floats); !r) return r;
    }
  }
  if (auto r = check_permutation(node); !r) return r;
  return check_constants(node, graph);
}

Result<void> check_interface(const OnnxGraph& graph) {
  for (const auto& [name, dims] : graph.declared) {
    std::vector<std::int64_t> known = dims;
    for (std::int64_t& d : known) d = d == -1 ? 1 : d;
    if (const auto size = count_numbers(known); !size) {
      return Error{fmt::format("damaged: '{}' {}", on_one_line(name), size.error().message)};
    }
  }
  if (graph.outputs.empty()) return Error{"has no output"};
  return {};
}

/// Every value is made once, before anybody reads it.
Result<void> check_order(const OnnxGraph& graph) {
  Names made(graph.inputs.begin(), graph.inputs.end());
  if (made.size() != graph.inputs.size()) return Error{"damaged: two inputs of one name"};
  for (const auto& constant : graph.constants) made.insert(constant.first);
  for (const OnnxNode& node : graph.nodes) {
    for (const std::string& input : node.inputs) {
      if (input.empty() || made.contains(input)) continue;
      return Error{
          fmt::format("damaged: {} reads '{}', which nothing before it makes (a missing operator, "
                      "or a circle)",
                      describe(node), on_one_line(input))};
    }
    for (const std::string& output : node.outputs) {
      if (output.empty() || made.insert(output).second) continue;
      return Error{fmt::format("damaged: '{}' is made twice", on_one_line(output))};
    }
  }
  for (const std::string& output : graph.outputs) {
    if (made.contains(output)) continue;
    return Error{fmt::format("damaged: nothing makes its output '{}'", on_one_line(output))};
  }
  return {};
}

}  // namespace

std::string describe(const OnnxNode& node) {
  const std::string op = on_one_line(node.op);
  if (node.outputs.empty()) return "operator " + op;
  return fmt::format("operator {} (makes '{}')", op, on_one_line(node.outputs.front()));
}

Result<void> check_attributes(const OnnxGraph& graph) {
  if (graph.nodes.size() > kMostNodes) {
    return Error{
        fmt::format("has {} operators; networks have at most {}", graph.nodes.size(), kMostNodes)};
  }
  for (const OnnxNode& node : graph.nodes) {
    if (auto r = check_form(node); !r) return r;
    if (auto r = check_node(node, graph); !r) return r;
  }
  return {};
}

Result<void> check_graph(const OnnxGraph& graph) {
  if (auto r = check_attributes(graph); !r) return r;
  if (auto r = check_interface(graph); !r) return r;
  return check_order(graph);
}

}  // namespace ydd
