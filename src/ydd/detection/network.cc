// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/network.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/detection/network_backends.h"

namespace ydd {
namespace {

/// The quickest that can: docs/adr/0007-inference-back-ends.md. OpenCV's reason is the one that
/// counts, as it reads most kinds of networks.
SessionResult make_quickest_session(std::string_view onnx, const InferenceOptions& options) {
  if (options.device != "cpu") return make_opencv_session(onnx, options);
  SessionResult quick = make_onednn_session(onnx, options);
  if (quick) return quick;
  log::debug("oneDNN does not take this network: {}", quick.error().message);
  if (options.precision == "bfloat16") return quick.error();
  if (!options.onnxruntime.empty()) return make_onnxruntime_session(onnx, options);
  return make_opencv_session(onnx, options);
}

SessionResult make_session(std::string_view onnx, const InferenceOptions& options) {
  if (options.device != "cpu" && options.backend != "auto" && options.backend != "opencv") {
    return Error{fmt::format("'device: {}' needs 'backend: opencv'", options.device)};
  }
  if (options.backend == "onednn") return make_onednn_session(onnx, options);
  if (options.backend == "onnxruntime") return make_onnxruntime_session(onnx, options);
  if (options.backend == "opencv") return make_opencv_session(onnx, options);
  return make_quickest_session(onnx, options);
}

}  // namespace

std::string format_shape(const std::vector<int>& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

void InferenceOptions::describe(OptionTable& table) {
  table.add("backend", backend, {"auto", "onednn", "onnxruntime", "opencv"},
            "library that runs the network; auto: the quickest that can (oneDNN, else ONNX Runtime "
            "if its library is named, else OpenCV)");
  table.add("device", device, {"cpu", "cuda"},
            "cuda needs backend opencv and an OpenCV that was built with it");
  table.add("precision", precision, {"auto", "float32", "bfloat16", "float16"},
            "auto: bfloat16 where the processor multiplies matrices of it (AMX), else float32; "
            "bfloat16 needs backend onednn, float16 device cuda");
  table.add("threads", threads, {1, 64}, "",
            "processor cores for one picture; tracking needs the others");
  table.add("onnxruntime", onnxruntime, {},
            "shared library of ONNX Runtime (libonnxruntime.so.1); empty: where the system has it");
}

Result<std::unique_ptr<InferenceSession>> load_network(const std::filesystem::path& onnx_file,
                                                       const InferenceOptions& options) {
  const Result<std::string> bytes = read_file(onnx_file);
  if (!bytes) return bytes.error();
  const auto failure = [&](const std::string& reason) {
    return Error{fmt::format("{}: {}", onnx_file.string(), reason)};
  };
  if (auto complete = check_onnx(*bytes); !complete) return failure(complete.error().message);
  SessionResult session = make_session(*bytes, options);
  if (!session) return failure(session.error().message);
  return session;
}

}  // namespace ydd
