// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/inference/protobuf_wire.h"

namespace ydd {

/// A constant of a network, row-major: numbers of one of the two kinds. Of other kinds (half
/// floats, bytes, truth values) only the size is kept.
struct OnnxTensor {
  std::vector<std::int64_t> dims;
  std::vector<float> floats;
  std::vector<std::int64_t> integers;

  std::int64_t size() const;  ///< product of dims
};

/// A tensor and what the graph calls it.
struct NamedTensor {
  std::string name;
  OnnxTensor tensor;
};

/// No value of a network that looks at one picture is larger: 2^28 numbers are a gigabyte.
constexpr std::int64_t kMostNumbers = std::int64_t{1} << 28U;

/// Reads a TensorProto that lies inside the file and holds just as many numbers as its size says.
Result<NamedTensor> read_tensor(std::string_view message);

/// The product of `dims`; fails when one is negative, there are more than eight, or the product
/// goes beyond kMostNumbers.
Result<std::int64_t> count_numbers(const std::vector<std::int64_t>& dims);

/// Numbers of type Raw, one after the other.
template <class Raw, class Value>
void append_raw(std::string_view bytes, std::vector<Value>& out) {
  out.reserve(out.size() + bytes.size() / sizeof(Raw));
  for (; bytes.size() >= sizeof(Raw); bytes.remove_prefix(sizeof(Raw))) {
    Raw value;
    std::memcpy(&value, bytes.data(), sizeof(Raw));
    out.push_back(static_cast<Value>(value));
  }
}

/// A repeated float: packed into one field, or one field each.
inline void append_floats(const WireField& field, std::vector<float>& out) {
  if (field.kind == WireField::Kind::fixed32) {
    out.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(field.number)));
  } else {
    append_raw<float>(field.bytes, out);
  }
}

}  // namespace ydd
