// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/base/result.h"

namespace ydd {

/// A view of a dense array of floats; whoever made it owns the values.
struct Tensor {
  std::vector<int> shape;  ///< outermost first: {batch, channels, height, width}
  std::span<const float> values;
  /// Values row-major in the order of `shape`; or, with four dimensions, all channels of a pixel
  /// beside each other: {batch, height, width, channels}, as some libraries compute them.
  bool channels_last = false;
};

/// "[1, 8, 60, 80]".
std::string format_shape(const std::vector<int>& shape);

/// A loaded network on some inference library. Thread: one call at a time, any thread.
class InferenceSession {
 public:
  virtual ~InferenceSession() = default;
  /// All outputs of the network for `input` (which is row-major). They belong to the session and
  /// stay valid until the next call. Fails when the network cannot take an input of this shape.
  virtual Result<std::vector<Tensor>> run(const Tensor& input) = 0;
  /// Where it is computed, for whoever reads results: "cpu" or "cuda"; with the reason in brackets
  /// where something else was asked for.
  virtual std::string device() const { return "cpu"; }
};

enum class Backend { automatic, onednn, onnxruntime, opencv };
constexpr std::array<std::string_view, 4> choices_of(Backend) {
  return {"auto", "onednn", "onnxruntime", "opencv"};
}
enum class Device { automatic, cpu, cuda };
constexpr std::array<std::string_view, 3> choices_of(Device) { return {"auto", "cpu", "cuda"}; }
enum class Precision { automatic, float32, bfloat16, float16, int8 };
constexpr std::array<std::string_view, 5> choices_of(Precision) {
  return {"auto", "float32", "bfloat16", "float16", "int8"};
}

/// By what a network is run; describe() has the sentences.
struct InferenceOptions {
  Backend backend = Backend::automatic;
  Device device = Device::cpu;
  Precision precision = Precision::automatic;
  int threads = 1;
  std::string onnxruntime{};  ///< shared library
  /// For int8: the largest magnitude that the input of each convolution takes on ordinary pictures,
  /// in the order of the file. No option of the table, as it is a list: its reader sets it.
  std::vector<float> ranges{};
  /// The size of picture that it will get, where the file leaves it open; 0: not known yet.
  int input_width_px = 0, input_height_px = 0;
  void describe(OptionTable& table);
};

/// Loads an ONNX file. The failure is one line that names the file: missing, not ONNX, truncated,
/// operators that the library does not know, a back end that this machine does not have. A GPU that
/// is asked for and not there is no failure: the CPU computes then, and one warning says why.
Result<std::unique_ptr<InferenceSession>> load_network(const std::filesystem::path& onnx_file,
                                                       const InferenceOptions& options);

/// Whether `bytes` hold one complete ONNX model, as far as its outermost structure tells; the
/// failure says what is wrong ("truncated: ..."), without naming a file.
Result<void> check_onnx(std::string_view bytes);

}  // namespace ydd
