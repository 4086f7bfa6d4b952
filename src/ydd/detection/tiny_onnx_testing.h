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

namespace ydd::testing_onnx {

inline std::string varint(std::uint64_t value) {
  std::string out;
  for (; value >= 0x80; value >>= 7U) out += static_cast<char>((value & 0x7FU) | 0x80U);
  return out + static_cast<char>(value);
}
inline std::string number(unsigned field, std::uint64_t value) {
  return varint(field << 3U) + varint(value);
}
inline std::string bytes(unsigned field, std::string_view content) {
  return varint((field << 3U) | 2U) + varint(content.size()) + std::string(content);
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
  std::memcpy(raw.data(), values.data(), raw.size());
  std::string out;
  for (const std::uint64_t d : dims) out += number(1, d);
  return out + number(2, 1) + bytes(8, name) + bytes(9, raw);
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

inline void write(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

}  // namespace ydd::testing_onnx
