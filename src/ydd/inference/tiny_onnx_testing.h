// SPDX-License-Identifier: Apache-2.0
#pragma once

// For tests only: small ONNX files written by hand, so that the whole way from file to boxes runs
// without any trained weights. Field numbers are those of onnx.proto.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/inference/protobuf_wire.h"

namespace ydd::testing_onnx {

inline std::string number(unsigned field, std::uint64_t value) {
  return number_field(field, value);
}
inline std::string bytes(unsigned field, std::string_view content) {
  return bytes_field(field, content);
}

inline std::string ints(std::string_view name, const std::vector<std::uint64_t>& values) {
  constexpr std::uint64_t kInts = 7;
  std::string attribute = bytes(1, name);
  for (const std::uint64_t v : values) attribute += number(8, v);
  return bytes(5, attribute + number(20, kInts));
}

inline std::string tensor(std::string_view name, const std::vector<std::uint64_t>& dims,
                          const std::vector<float>& values) {
  std::string raw(values.size() * sizeof(float), '\0');
  if (!raw.empty()) std::memcpy(raw.data(), values.data(), raw.size());
  std::string out;
  for (const std::uint64_t d : dims) out += number(1, d);
  return out + number(2, 1) + bytes(8, name) + bytes(9, raw);
}

/// A tensor of 64-bit integers.
inline std::string integer_tensor(std::string_view name, const std::vector<std::uint64_t>& dims,
                                  const std::vector<std::int64_t>& values) {
  std::string raw(values.size() * sizeof(std::int64_t), '\0');
  if (!raw.empty()) std::memcpy(raw.data(), values.data(), raw.size());
  std::string out;
  for (const std::uint64_t d : dims) out += number(1, d);
  return out + number(2, 7) + bytes(8, name) + bytes(9, raw);
}

/// A float tensor of the graph's interface; a dim of 0 stays open.
inline std::string value_info(std::string_view name, const std::vector<std::uint64_t>& dims) {
  std::string shape;
  for (const std::uint64_t d : dims) {
    shape += bytes(1, d == 0 ? bytes(2, "any") : number(1, d));
  }
  return bytes(1, name) + bytes(2, bytes(1, number(1, 1) + bytes(2, shape)));
}

inline std::string model(const std::string& graph) {
  return number(1, 7) + bytes(7, graph) + bytes(8, bytes(1, "") + number(2, 12));
}

/// A model of one operator without parameters from `images` to `output`.
inline std::string single_operator_model(std::string_view op) {
  const std::string node = bytes(1, "images") + bytes(2, "output") + bytes(3, "n") + bytes(4, op);
  return model(bytes(1, node) + bytes(2, "g") + bytes(11, value_info("images", {1, 3, 0, 0})) +
               bytes(12, value_info("output", {1, 3, 0, 0})));
}

/// A network laid out as YOLOX heads with three classes that "sees" colours: each pixel whose both
/// coordinates are multiples of 8 gives a box of 32 x 32 pixels around (x + 4, y + 4), whose
/// classes are the pixel's blue, green and red, and whose objectness is their sum, all / 255.
/// Strides 16 and 32 stay silent.
inline std::string colour_spotter_model() {
  constexpr std::uint64_t kChannels = 8;
  constexpr float kByte = 1.0F / 255.0F;
  std::string nodes;
  std::string initialisers;
  std::string outputs;
  for (const std::uint64_t stride : {8U, 16U, 32U}) {
    const std::string s = std::to_string(stride);
    std::vector<float> weights(kChannels * 3, 0.0F);
    std::vector<float> bias(kChannels, 0.0F);
    bias[0] = bias[1] = 0.5F;
    bias[2] = bias[3] = std::log(4.0F);
    bias[4] = stride == 8 ? 0.0F : -10.0F;
    for (std::size_t c = 0; c < 3; ++c) weights[4 * 3 + c] = weights[(5 + c) * 3 + c] = kByte;
    nodes += bytes(1, bytes(1, "images") + bytes(1, "w" + s) + bytes(1, "b" + s) +
                          bytes(2, "p" + s) + bytes(3, "conv" + s) + bytes(4, "Conv") +
                          ints("kernel_shape", {1, 1}) + ints("strides", {stride, stride}) +
                          ints("pads", {0, 0, 0, 0}) + ints("dilations", {1, 1}));
    initialisers += bytes(5, tensor("w" + s, {kChannels, 3, 1, 1}, weights));
    initialisers += bytes(5, tensor("b" + s, {kChannels}, bias));
    outputs += bytes(12, value_info("p" + s, {1, kChannels, 0, 0}));
  }
  return model(nodes + bytes(2, "g") + initialisers +
               bytes(11, value_info("images", {1, 3, 0, 0})) + outputs);
}

/// Nodes and weights put together by hand; names of values are those of the nodes that make them.
class GraphWriter {
 public:
  /// Deterministic weights of about unit gain.
  std::string convolution(const std::string& from, std::uint64_t in, std::uint64_t out,
                          std::uint64_t kernel, std::uint64_t stride = 1, std::uint64_t group = 1) {
    std::string name = next("conv");
    const std::uint64_t fan_in = in / group * kernel * kernel;
    std::vector<float> weights(out * fan_in);
    std::vector<float> bias(out);
    for (float& w : weights) w = noise() * 1.7F / std::sqrt(static_cast<float>(fan_in));
    for (float& b : bias) b = 0.2F * noise();
    const std::uint64_t pad = kernel / 2;
    nodes_ +=
        bytes(1, bytes(1, from) + bytes(1, "w" + name) + bytes(1, "b" + name) + bytes(2, name) +
                     bytes(3, name) + bytes(4, "Conv") + ints("kernel_shape", {kernel, kernel}) +
                     ints("strides", {stride, stride}) + ints("pads", {pad, pad, pad, pad}) +
                     integer("group", group));
    initialisers_ += bytes(5, tensor("w" + name, {out, in / group, kernel, kernel}, weights));
    initialisers_ += bytes(5, tensor("b" + name, {out}, bias));
    return name;
  }
  std::string node(const std::string& op, const std::vector<std::string>& from,
                   const std::string& attributes = "") {
    std::string name = next(op);
    std::string inputs;
    for (const std::string& f : from) inputs += bytes(1, f);
    nodes_ += bytes(1, inputs + bytes(2, name) + bytes(3, name) + bytes(4, op) + attributes);
    return name;
  }
  std::string silu(const std::string& from) { return node("Mul", {from, node("Sigmoid", {from})}); }
  std::string constant(const std::vector<float>& values) {
    std::string name = next("constant");
    initialisers_ += bytes(5, tensor(name, {values.size()}, values));
    return name;
  }
  std::string twice(const std::string& from) {
    return node("Resize", {from, constant({}), constant({1, 1, 2, 2})},
                text("mode", "nearest") + text("coordinate_transformation_mode", "asymmetric") +
                    text("nearest_mode", "floor"));
  }
  std::string concat(const std::vector<std::string>& from) {
    return node("Concat", from, integer("axis", 1));
  }
  std::string pool(const std::string& from, std::uint64_t kernel) {
    const std::uint64_t pad = kernel / 2;
    return node("MaxPool", {from},
                ints("kernel_shape", {kernel, kernel}) + ints("strides", {1, 1}) +
                    ints("pads", {pad, pad, pad, pad}));
  }
  std::string finish(const std::vector<std::string>& results) const {
    std::string outputs;
    for (const std::string& r : results) outputs += bytes(12, value_info(r, {1, 0, 0, 0}));
    return model(nodes_ + bytes(2, "g") + initialisers_ +
                 bytes(11, value_info("images", {1, 3, 0, 0})) + outputs);
  }
  static std::string integer(std::string_view name, std::uint64_t value) {
    constexpr std::uint64_t kInt = 2;
    return bytes(5, bytes(1, name) + number(3, value) + number(20, kInt));
  }
  static std::string text(std::string_view name, std::string_view value) {
    constexpr std::uint64_t kString = 3;
    return bytes(5, bytes(1, name) + bytes(4, value) + number(20, kString));
  }

 private:
  std::string next(const std::string& kind) { return kind + std::to_string(++count_); }
  float noise() {  // in [-1, 1]
    state_ = state_ * 1664525U + 1013904223U;
    return static_cast<float>(state_ >> 8U) / static_cast<float>(1U << 23U) - 1.0F;
  }
  std::string nodes_, initialisers_;
  int count_ = 0;
  std::uint32_t state_ = 1;
};

/// Everything that the networks of YOLO detectors are made of, small: strided, grouped and
/// pointwise convolutions with every activation, a residual, pooling, upsampling, concatenation,
/// heads for `classes` classes as YOLOX has them.
inline std::string miniature_yolo_model(std::uint64_t classes = 3) {
  GraphWriter g;
  const auto head = [&](const std::string& from, std::uint64_t channels) {
    const std::string box = g.convolution(from, channels, 4, 1);
    const std::string objectness = g.node("Sigmoid", {g.convolution(from, channels, 1, 1)});
    const std::string kinds = g.node("Sigmoid", {g.convolution(from, channels, classes, 1)});
    return g.concat({box, objectness, kinds});
  };
  const std::string stem = g.silu(g.convolution("images", 3, 16, 3, 2));
  const std::string s4 = g.node("Relu", {g.convolution(stem, 16, 16, 3, 2)});
  const std::string s8 = g.silu(g.convolution(s4, 16, 32, 3, 2));
  const std::string narrow = g.silu(g.convolution(s8, 32, 16, 1));
  const std::string inner =
      g.silu(g.convolution(g.silu(g.convolution(narrow, 16, 16, 1)), 16, 16, 3));
  const std::string sum = g.node("Add", {narrow, inner});
  const std::string joined = g.concat({sum, g.silu(g.convolution(s8, 32, 16, 1))});
  const std::string deep = g.silu(g.convolution(joined, 32, 32, 3, 1, 32));
  const std::string s16 = g.node("LeakyRelu", {g.convolution(deep, 32, 24, 3, 2)});
  const std::string s32 = g.silu(g.convolution(s16, 24, 24, 3, 2));
  const std::string pooled =
      g.silu(g.convolution(g.concat({s32, g.pool(s32, 5), g.pool(g.pool(s32, 3), 3)}), 72, 24, 1));
  const std::string up = g.silu(g.convolution(g.concat({g.twice(pooled), s16}), 48, 24, 3));
  const std::string gated = g.node("Mul", {up, g.node("Add", {up, s16})});
  return g.finish({head(g.node("Add", {deep, joined}), 32), head(gated, 24), head(pooled, 24)});
}

inline void write(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

}  // namespace ydd::testing_onnx
