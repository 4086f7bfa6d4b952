// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/onnx_tensor.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/yaml_reader.h"

namespace ydd {
namespace {

/// TensorProto.DataType. Where a number lies that has no list of its own type: among the 32-bit
/// integers or the 64-bit ones.
struct ElementType {
  std::uint64_t code;
  std::size_t bytes;  // of one number in raw_data
  int list;           // field that holds them otherwise
};
constexpr std::uint64_t kOnnxFloat = 1;
constexpr std::uint64_t kInt32 = 6;
constexpr std::uint64_t kInt64 = 7;
constexpr std::array<ElementType, 13> kElementTypes = {{{kOnnxFloat, 4, 4},
                                                        {2, 1, 5},  // uint8
                                                        {3, 1, 5},  // int8
                                                        {4, 2, 5},  // uint16
                                                        {5, 2, 5},  // int16
                                                        {kInt32, 4, 5},
                                                        {kInt64, 8, 7},
                                                        {9, 1, 5},     // bool
                                                        {10, 2, 5},    // float16
                                                        {11, 8, 10},   // double
                                                        {12, 4, 11},   // uint32
                                                        {13, 8, 11},   // uint64
                                                        {16, 2, 5}}};  // bfloat16

/// A TensorProto as it stands in the file.
struct Read {
  NamedTensor out;
  std::uint64_t type = 0;
  std::string_view raw;
  std::vector<std::int64_t> int32s, int64s, uint64s;
  std::size_t doubles = 0;
  bool external = false;

  std::size_t listed(int field) const {
    if (field == 4) return out.tensor.floats.size();
    if (field == 5) return int32s.size();
    if (field == 7) return int64s.size();
    return field == 10 ? doubles : uint64s.size();
  }
  std::size_t listed() const { return listed(4) + listed(5) + listed(7) + listed(10) + listed(11); }
};

Result<void> read_field(const WireField& f, Read& read) {
  switch (f.id) {
    case 1:
      return append_integers(f, read.out.tensor.dims);
    case 2:
      read.type = f.number;
      return {};
    case 4:
      append_floats(f, read.out.tensor.floats);
      return {};
    case 5:
      return append_integers(f, read.int32s);
    case 7:
      return append_integers(f, read.int64s);
    case 8:
      read.out.name = f.bytes;
      return {};
    case 9:
      read.raw = f.bytes;
      return {};
    case 10:
      read.doubles += f.kind == WireField::Kind::bytes ? f.bytes.size() / 8 : 1;
      return {};
    case 11:
      return append_integers(f, read.uint64s);
    case 14:
      read.external = f.number != 0;
      return {};
    default:
      return {};
  }
}

/// Whether all numbers are there, in one place.
Result<void> check_content(const Read& read, const ElementType& type) {
  const std::string name = on_one_line(read.out.name);
  const Result<std::int64_t> size = count_numbers(read.out.tensor.dims);
  if (!size) return Error{fmt::format("damaged: tensor '{}' {}", name, size.error().message)};
  const auto wanted = static_cast<std::size_t>(*size);
  const std::size_t held = read.raw.empty() ? read.listed(type.list) : read.raw.size() / type.bytes;
  const bool both = !read.raw.empty() && read.listed() > 0;
  if (held != wanted || both || read.raw.size() % type.bytes != 0 ||
      read.listed() > read.listed(type.list)) {
    return Error{fmt::format("damaged: tensor '{}' holds {} numbers instead of {}", name,
                             held + (both ? read.listed() : 0), wanted)};
  }
  return {};
}

}  // namespace

std::int64_t OnnxTensor::size() const {
  return std::accumulate(dims.begin(), dims.end(), std::int64_t{1}, std::multiplies<>());
}

Result<std::int64_t> count_numbers(const std::vector<std::int64_t>& dims) {
  constexpr std::size_t kMostDimensions = 8;
  if (dims.size() > kMostDimensions) {
    return Error{fmt::format("has {} dimensions", dims.size())};
  }
  std::int64_t size = 1;
  for (const std::int64_t d : dims) {
    if (d < 0) return Error{fmt::format("has a size of {}", d)};
    if (d > kMostNumbers || (size > 0 && d > kMostNumbers / size)) {
      return Error{fmt::format("would hold more than {} numbers", kMostNumbers)};
    }
    size *= d;
  }
  return size;
}

Result<NamedTensor> read_tensor(std::string_view message) {
  Read read;
  auto done = for_each_field(message, [&](const WireField& f) { return read_field(f, read); });
  if (!done) return done.error();
  const std::string name = on_one_line(read.out.name);
  if (read.external) return Error{fmt::format("tensor '{}' lies in a file of its own", name)};
  const auto type = std::find_if(kElementTypes.begin(), kElementTypes.end(),
                                 [&](const ElementType& t) { return t.code == read.type; });
  if (type == kElementTypes.end()) {
    return Error{
        fmt::format("tensor '{}' holds something of ONNX type {}, not numbers", name, read.type)};
  }
  if (auto whole = check_content(read, *type); !whole) return whole.error();
  OnnxTensor& tensor = read.out.tensor;
  if (read.type == kOnnxFloat) append_raw<float>(read.raw, tensor.floats);
  if (read.type == kInt32) {
    tensor.integers = std::move(read.int32s);
    append_raw<std::int32_t>(read.raw, tensor.integers);
  }
  if (read.type == kInt64) {
    tensor.integers = std::move(read.int64s);
    append_raw<std::int64_t>(read.raw, tensor.integers);
  }
  return std::move(read.out);
}

}  // namespace ydd
