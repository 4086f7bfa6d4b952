// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/onnx_sizes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace ydd {
namespace {

using Ints = std::vector<std::int64_t>;

/// How large a value is: its dimensions where they are known, else no more numbers than `most`.
struct Size {
  std::optional<Ints> dims;
  std::int64_t most = 0;
};
using SizeResult = Result<Size>;

SizeResult sized(Ints dims) {
  const Result<std::int64_t> count = count_numbers(dims);
  if (!count) return count.error();
  return Size{std::move(dims), *count};
}

/// Products saturate: whatever is above kMostNumbers is refused.
SizeResult at_most(double count) {
  if (!(count <= static_cast<double>(kMostNumbers))) {
    return Error{fmt::format("would hold more than {} numbers", kMostNumbers)};
  }
  return Size{std::nullopt, static_cast<std::int64_t>(count)};
}

/// An axis counted from either end, or nothing.
std::optional<std::size_t> axis_in(std::int64_t axis, std::size_t rank) {
  const auto count = static_cast<std::int64_t>(rank);
  if (axis < -count || axis >= count) return std::nullopt;
  return static_cast<std::size_t>(axis < 0 ? axis + count : axis);
}

bool is_one_of(std::string_view op, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), op) != names.end();
}

/// Number by number; the last dimensions belong together, and one of size 1 is repeated.
SizeResult joined(Ints dims, Ints other) {
  if (other.size() > dims.size()) std::swap(dims, other);
  const std::size_t shift = dims.size() - other.size();
  for (std::size_t d = 0; d < other.size(); ++d) {
    std::int64_t& size = dims[d + shift];
    if (size != other[d] && size != 1 && other[d] != 1) {
      return Error{fmt::format("joins maps of different sizes ({} and {})", size, other[d])};
    }
    size = size == 1 ? other[d] : size;
  }
  return sized(std::move(dims));
}

class Walk {
 public:
  explicit Walk(const OnnxGraph& graph) : graph_(graph) {
    for (const auto& [name, tensor] : graph.constants) {
      sizes_[name] = Size{tensor.dims, tensor.size()};
    }
  }

  Result<void> run(const Ints& input_dims) {
    for (const std::string& input : graph_.inputs) {
      if (input_dims.empty()) {
        sizes_[input] = Size{std::nullopt, 1};
        continue;
      }
      const SizeResult size = sized(input_dims);
      if (!size) return Error{"the input " + size.error().message};
      sizes_[input] = *size;
    }
    for (const OnnxNode& node : graph_.nodes) {
      const SizeResult size = after(node);
      if (!size) {
        return Error{fmt::format("{} {}", describe(node), size.error().message)};
      }
      for (const std::string& output : node.outputs) sizes_[output] = *size;
    }
    return {};
  }

 private:
  const Size& input(const OnnxNode& node, std::size_t i) const {
    static const Size kAbsent{std::nullopt, 0};
    if (i >= node.inputs.size()) return kAbsent;
    const auto found = sizes_.find(node.inputs[i]);
    return found == sizes_.end() ? kAbsent : found->second;
  }

  const OnnxTensor* constant(const OnnxNode& node, std::size_t i) const {
    if (i >= node.inputs.size()) return nullptr;
    const auto found = graph_.constants.find(node.inputs[i]);
    return found == graph_.constants.end() ? nullptr : &found->second;
  }

  /// A list that is an attribute in older versions of an operator and a constant in newer ones.
  std::optional<Ints> list(const OnnxNode& node, std::string_view attribute, std::size_t i) const {
    if (node.attributes.contains(attribute)) return node.integers(attribute, {});
    const OnnxTensor* held = constant(node, i);
    if (held == nullptr || (held->integers.empty() && held->size() != 0)) return std::nullopt;
    return held->integers;
  }

  SizeResult after(const OnnxNode& node) const {
    const std::string_view op = node.op;
    if (op == "Conv") return convolution(node);
    if (op == "ConvTranspose") return transposed_convolution(node);
    if (is_one_of(op, {"MaxPool", "AveragePool", "LpPool"})) return pool(node);
    if (op == "Resize" || op == "Upsample") return resize(node);
    if (op == "Concat") return concat(node);
    if (op == "Split") return split(node);
    if (op == "Slice") return slice(node);
    if (op == "Transpose") return transpose(node);
    if (op == "Reshape") return reshape(node);
    if (op == "Pad") return pad(node);
    if (op == "Tile") return tile(node);
    if (is_one_of(op, {"Expand", "ConstantOfShape"})) return expand(node);
    if (is_one_of(op, {"MatMul", "Gemm"})) return product(node);
    if (op == "Gather") return gather(node);
    if (is_one_of(op, {"Add", "Sub", "Mul", "Div", "Pow", "PRelu", "Min", "Max", "Where", "Equal",
                       "Greater", "Less", "And", "Or", "Sum", "Mean"})) {
      return broadcast(node);
    }
    if (is_one_of(op, {"Flatten", "Squeeze", "Unsqueeze", "DepthToSpace", "SpaceToDepth"})) {
      return Size{std::nullopt, input(node, 0).most};
    }
    return as_inputs(node);
  }

  /// One number by another, and all that is not known: no larger than what it is made of.
  SizeResult as_inputs(const OnnxNode& node) const {
    static constexpr std::array<std::string_view, 17> kEach = {
        "Relu",     "LeakyRelu", "Sigmoid", "Tanh", "Clip",       "Exp",
        "Softmax",  "Identity",  "Cast",    "Elu",  "Dropout",    "BatchNormalization",
        "Softplus", "HardSwish", "Neg",     "Sqrt", "HardSigmoid"};
    if (std::find(kEach.begin(), kEach.end(), node.op) != kEach.end()) return input(node, 0);
    Size out;
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
      out.most = std::max(out.most, input(node, i).most);
    }
    return out;
  }

  /// Size of one axis after a window went over it.
  static Result<std::int64_t> windowed(const OnnxNode& node, std::int64_t size, const Ints& kernel,
                                       std::size_t i) {
    const auto entry = [&](const char* name, std::size_t at, std::int64_t otherwise) {
      const Ints list = node.integers(name, {});
      return at < list.size() ? list[at] : otherwise;
    };
    const std::int64_t stride = entry("strides", i, 1);
    const std::string automatic = node.text("auto_pad", "NOTSET");
    if (automatic.starts_with("SAME")) return (size + stride - 1) / stride;
    const std::int64_t reach = (kernel[i] - 1) * entry("dilations", i, 1) + 1;
    const std::int64_t room = size + entry("pads", i, 0) + entry("pads", i + kernel.size(), 0);
    if (room < reach) {
      return Error{fmt::format("looks at windows of {}, but has only {}", reach, room)};
    }
    const std::int64_t rest = node.integer("ceil_mode", 0) != 0 ? stride - 1 : 0;
    return (room - reach + rest) / stride + 1;
  }

  static SizeResult windows(const OnnxNode& node, const Size& in, std::int64_t channels,
                            const Ints& kernel) {
    if (!in.dims) return at_most(static_cast<double>(in.most));
    if (in.dims->size() != kernel.size() + 2) {
      return Error{fmt::format("has windows of {} dimensions for a map of {}", kernel.size(),
                               in.dims->size())};
    }
    Ints dims{(*in.dims)[0], channels};
    for (std::size_t i = 0; i < kernel.size(); ++i) {
      const Result<std::int64_t> side = windowed(node, (*in.dims)[i + 2], kernel, i);
      if (!side) return side.error();
      dims.push_back(*side);
    }
    return sized(std::move(dims));
  }

  SizeResult convolution(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const Size& weights = input(node, 1);
    if (!weights.dims || weights.dims->size() < 3) return Error{"has weights of no known size"};
    const Ints& w = *weights.dims;
    const std::int64_t group = node.integer("group", 1);
    if (w[0] < 1 || w[1] < 1 || w[0] % group != 0) return Error{"has groups that do not fit"};
    const Ints kernel(w.begin() + 2, w.end());
    if (node.integers("kernel_shape", kernel) != kernel) {
      return Error{"has weights of another size than its window"};
    }
    if (in.dims && in.dims->size() > 1 && (*in.dims)[1] != w[1] * group) {
      return Error{fmt::format("takes {} channels and gets {}", w[1] * group, (*in.dims)[1])};
    }
    const Size& bias = input(node, 2);
    if (bias.dims && *bias.dims != Ints{w[0]}) return Error{"has a bias that does not fit"};
    return windows(node, in, w[0], kernel);
  }

  SizeResult transposed_convolution(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const Size& weights = input(node, 1);
    if (!weights.dims || weights.dims->size() < 3) return Error{"has weights of no known size"};
    double count =
        static_cast<double>((*weights.dims)[1]) * static_cast<double>(node.integer("group", 1));
    if (!in.dims || in.dims->size() != weights.dims->size()) {
      return Error{"gets something of no known size"};
    }
    const Ints strides = node.integers("strides", Ints(in.dims->size() - 2, 1));
    const Ints dilations = node.integers("dilations", Ints(in.dims->size() - 2, 1));
    for (std::size_t i = 2; i < in.dims->size(); ++i) {
      if (i - 2 >= strides.size() || i - 2 >= dilations.size()) return Error{"has too few strides"};
      count *= static_cast<double>((*in.dims)[i] * strides[i - 2] +
                                   (*weights.dims)[i] * dilations[i - 2] + 4096);
    }
    const SizeResult largest = at_most(count * static_cast<double>((*in.dims)[0]));
    if (!largest) return largest.error();
    return Size{std::nullopt, largest->most};
  }

  SizeResult pool(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const Ints kernel = node.integers("kernel_shape", {});
    if (kernel.empty()) return Error{"has no window"};
    return windows(node, in, in.dims && in.dims->size() > 1 ? (*in.dims)[1] : 1, kernel);
  }

  SizeResult resize(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const std::size_t last = node.inputs.size() - 1;
    if (const OnnxTensor* sizes = node.op == "Resize" ? constant(node, 3) : nullptr;
        sizes != nullptr && !sizes->integers.empty()) {
      return sized(sizes->integers);
    }
    std::vector<float> scales;
    if (const auto a = node.attributes.find("scales"); a != node.attributes.end()) {
      scales = a->second.floats;
    } else if (const OnnxTensor* held = constant(node, std::min<std::size_t>(last, 2))) {
      scales = held->floats;
    }
    if (!in.dims || scales.empty()) {
      double count = static_cast<double>(in.most);
      for (const float s : scales) count *= std::max(1.0, static_cast<double>(s));
      return at_most(count);
    }
    if (scales.size() != in.dims->size()) return Error{"has scales for other dimensions"};
    Ints dims = *in.dims;
    for (std::size_t i = 0; i < dims.size(); ++i) {
      dims[i] = static_cast<std::int64_t>(
          std::floor(static_cast<double>(dims[i]) * static_cast<double>(scales[i])));
    }
    return sized(std::move(dims));
  }

  SizeResult concat(const OnnxNode& node) const {
    double count = 0;
    bool known = true;
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
      count += static_cast<double>(input(node, i).most);
      known = known && input(node, i).dims;
    }
    if (!known) return at_most(count);
    Ints dims = *input(node, 0).dims;
    const auto axis = axis_in(node.integer("axis", 1), dims.size());
    if (!axis) return Error{"goes along a dimension that there is not"};
    for (std::size_t i = 1; i < node.inputs.size(); ++i) {
      const Ints& other = *input(node, i).dims;
      if (other.size() != dims.size()) return Error{"puts together what does not fit"};
      for (std::size_t d = 0; d < dims.size(); ++d) {
        if (d == *axis) {
          dims[d] += other[d];
        } else if (dims[d] != other[d]) {
          return Error{"puts together what does not fit: maps of different sizes"};
        }
      }
    }
    return sized(std::move(dims));
  }

  /// All parts are as large as the largest: no later operator becomes smaller than it is.
  SizeResult split(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    if (!in.dims) return in;
    Ints dims = *in.dims;
    const auto axis = axis_in(node.integer("axis", 0), dims.size());
    if (!axis) return Error{"goes along a dimension that there is not"};
    const auto parts = list(node, "split", 1);
    const auto count = static_cast<std::int64_t>(node.outputs.size());
    if (!parts || parts->empty()) {
      if (dims[*axis] % count == 0) {
        dims[*axis] /= count;
        return sized(std::move(dims));
      }
      return Size{std::nullopt, in.most};
    }
    std::int64_t sum = 0;
    for (const std::int64_t part : *parts) {
      if (part < 0 || part > dims[*axis]) return Error{"has parts that do not fit"};
      sum += part;
    }
    if (sum != dims[*axis] || static_cast<std::int64_t>(parts->size()) != count) {
      return Error{"has parts that do not fit"};
    }
    if (*std::max_element(parts->begin(), parts->end()) !=
        *std::min_element(parts->begin(), parts->end())) {
      return Size{std::nullopt, in.most};
    }
    dims[*axis] = parts->front();
    return sized(std::move(dims));
  }

  SizeResult slice(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const auto starts = list(node, "starts", 1);
    const auto ends = list(node, "ends", 2);
    if (!in.dims || !starts || !ends) return Size{std::nullopt, in.most};
    if (starts->size() != ends->size() || starts->size() > in.dims->size()) {
      return Error{"has starts and ends that do not fit each other"};
    }
    Ints axes = list(node, "axes", 3).value_or(Ints{});
    const Ints steps = list(node, "steps", 4).value_or(Ints{});
    if (axes.empty()) {
      for (std::size_t i = 0; i < starts->size(); ++i) axes.push_back(static_cast<int>(i));
    }
    if (axes.size() != starts->size() || (!steps.empty() && steps.size() != starts->size())) {
      return Error{"has axes or steps that do not fit its starts"};
    }
    Ints dims = *in.dims;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const auto axis = axis_in(axes[i], dims.size());
      if (!axis) return Error{"goes along a dimension that there is not"};
      const std::int64_t step = steps.empty() ? 1 : steps[i];
      if (step == 0) return Error{"has a step of 0"};
      if (step < 0) return Size{std::nullopt, in.most};
      const std::int64_t size = dims[*axis];
      const auto place = [&](std::int64_t at) {
        return std::clamp<std::int64_t>(at < 0 ? std::max(at, -size) + size : at, 0, size);
      };
      const std::int64_t length =
          std::max<std::int64_t>(place((*ends)[i]) - place((*starts)[i]), 0);
      dims[*axis] = length / step + (length % step != 0 ? 1 : 0);
    }
    return sized(std::move(dims));
  }

  SizeResult transpose(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    if (!in.dims) return in;
    Ints perm = node.integers("perm", {});
    if (perm.empty()) return sized({in.dims->rbegin(), in.dims->rend()});
    if (perm.size() != in.dims->size()) return Error{"orders other dimensions than there are"};
    Ints dims;
    for (const std::int64_t p : perm) dims.push_back((*in.dims)[static_cast<std::size_t>(p)]);
    return sized(std::move(dims));
  }

  SizeResult reshape(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const auto shape = list(node, "shape", 1);
    if (!in.dims || !shape) return Size{std::nullopt, in.most};
    Ints dims = *shape;
    std::optional<std::size_t> open;
    for (std::size_t i = 0; i < dims.size(); ++i) {
      if (dims[i] == 0 && i < in.dims->size()) dims[i] = (*in.dims)[i];
      if (dims[i] < -1 || (dims[i] == -1 && open)) return Error{"asks for a size that is none"};
      if (dims[i] != -1) continue;
      open = i;
      dims[i] = 1;
    }
    const Result<std::int64_t> count = count_numbers(dims);
    if (!count) return count.error();
    if (open) {
      if (*count == 0 || in.most % *count != 0) {
        return Error{fmt::format("cannot give {} numbers this form", in.most)};
      }
      dims[*open] = in.most / *count;
    } else if (*count != in.most) {
      return Error{fmt::format("would make {} numbers of {}", *count, in.most)};
    }
    return sized(std::move(dims));
  }

  SizeResult pad(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const auto pads = list(node, "pads", 1);
    if (!in.dims || !pads) return Size{std::nullopt, in.most};
    Ints dims = *in.dims;
    if (pads->size() != 2 * dims.size()) return Error{"has pads for other dimensions"};
    for (std::size_t i = 0; i < pads->size(); ++i) {
      if (std::abs((*pads)[i] % kMostNumbers) != std::abs((*pads)[i])) {
        return Error{fmt::format("has a pad of {}", (*pads)[i])};
      }
      dims[i % dims.size()] += (*pads)[i];
    }
    return sized(std::move(dims));
  }

  SizeResult tile(const OnnxNode& node) const {
    double count = static_cast<double>(input(node, 0).most);
    if (const auto repeats = list(node, "repeats", 1)) {
      for (const std::int64_t r : *repeats) {
        if (r < 0) return Error{fmt::format("repeats {} times", r)};
        count *= static_cast<double>(r);
      }
    }
    return at_most(count);
  }

  /// To a size that stands in a constant.
  SizeResult expand(const OnnxNode& node) const {
    const bool fills = node.op == "ConstantOfShape";
    const auto shape = list(node, "", fills ? 0 : 1);
    if (!shape) return as_inputs(node);
    const SizeResult asked = sized(*shape);
    const Size& in = input(node, 0);
    if (!asked || fills || !in.dims) return asked;
    return joined(*in.dims, *shape);
  }

  /// Rows of one by columns of the other: at most all pairs of their outer dimensions.
  SizeResult product(const OnnxNode& node) const {
    const Size& a = input(node, 0);
    const Size& b = input(node, 1);
    if (!a.dims || !b.dims || a.dims->empty() || b.dims->empty()) return as_inputs(node);
    if (node.op == "Gemm") {
      if (a.dims->size() != 2 || b.dims->size() != 2) return Error{"multiplies what is no matrix"};
      const auto row = static_cast<std::size_t>(node.integer("transA", 0) != 0);
      const auto column = static_cast<std::size_t>(node.integer("transB", 0) == 0);
      if ((*a.dims)[1 - row] != (*b.dims)[1 - column]) {
        return Error{"multiplies matrices that do not fit"};
      }
      return sized({(*a.dims)[row], (*b.dims)[column]});
    }
    const std::int64_t inner = a.dims->back();
    const std::int64_t other =
        b.dims->size() == 1 ? b.dims->front() : (*b.dims)[b.dims->size() - 2];
    if (inner != other) return Error{"multiplies matrices that do not fit"};
    if (b.dims->size() == 1) return at_most(static_cast<double>(a.most));
    if (b.dims->size() > 2 && a.dims->size() != b.dims->size()) return as_inputs(node);
    Ints dims = *a.dims;
    dims.back() = b.dims->back();
    for (std::size_t i = 0; b.dims->size() > 2 && i + 2 < dims.size(); ++i) {
      dims[i] = std::max(dims[i], (*b.dims)[i]);
    }
    return sized(std::move(dims));
  }

  SizeResult gather(const OnnxNode& node) const {
    const Size& in = input(node, 0);
    const Size& indices = input(node, 1);
    if (!in.dims || in.dims->empty()) return as_inputs(node);
    const auto axis = axis_in(node.integer("axis", 0), in.dims->size());
    if (!axis) return Error{"goes along a dimension that there is not"};
    const std::int64_t size = std::max<std::int64_t>((*in.dims)[*axis], 1);
    if (const OnnxTensor* held = constant(node, 1)) {
      for (const std::int64_t i : held->integers) {
        if (i < -size || i >= size) return Error{fmt::format("takes number {} of {}", i, size)};
      }
    }
    return at_most(static_cast<double>(in.most / size) *
                   static_cast<double>(std::max<std::int64_t>(indices.most, 1)));
  }

  SizeResult broadcast(const OnnxNode& node) const {
    SizeResult out = sized({});
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
      const Size& in = input(node, i);
      if (!in.dims) return as_inputs(node);
      out = joined(*out->dims, *in.dims);
      if (!out) return out;
    }
    return out;
  }

  const OnnxGraph& graph_;
  std::map<std::string, Size, std::less<>> sizes_;
};

}  // namespace

Result<void> check_sizes(const OnnxGraph& graph, const std::vector<std::int64_t>& input_dims) {
  return Walk(graph).run(input_dims);
}

}  // namespace ydd
