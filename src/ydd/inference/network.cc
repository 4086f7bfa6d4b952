// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/network.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/inference/network_backends.h"
#include "ydd/inference/onnx_graph.h"
#include "ydd/inference/onnx_sizes.h"

namespace ydd {
namespace {

/// The quickest that can: docs/adr/0007-inference-back-ends.md. OpenCV's reason is the one that
/// counts, as it reads most kinds of networks.
SessionResult make_quickest_session(std::string_view onnx, const InferenceOptions& options) {
  SessionResult quick = make_onednn_session(onnx, options);
  if (quick) return quick;
  log::debug("oneDNN does not take this network: {}", quick.error().message);
  if (options.precision == Precision::bfloat16 || options.precision == Precision::int8) {
    return quick.error();
  }
  if (!options.onnxruntime.empty()) return make_onnxruntime_session(onnx, options);
  return make_opencv_session(onnx, options);
}

SessionResult make_cpu_session(std::string_view onnx, const InferenceOptions& options) {
  if (options.backend == Backend::onednn) return make_onednn_session(onnx, options);
  if (options.backend == Backend::onnxruntime) return make_onnxruntime_session(onnx, options);
  if (options.backend == Backend::opencv) return make_opencv_session(onnx, options);
  return make_quickest_session(onnx, options);
}

/// On the GPU by the libraries that the options allow; the failure is why none of them can.
SessionResult make_cuda_session(std::string_view onnx, InferenceOptions options) {
  options.device = Device::cuda;
  std::string reasons;
  const auto failed = [&](const SessionResult& session) {
    if (!reasons.empty()) reasons += "; ";
    reasons += session.error().message;
  };
  if (options.backend != Backend::onnxruntime) {
    SessionResult session = make_opencv_session(onnx, options);
    if (session) return session;
    failed(session);
  }
  const bool named = options.backend == Backend::automatic && !options.onnxruntime.empty();
  if (options.backend == Backend::onnxruntime || named) {
    SessionResult session = make_onnxruntime_session(onnx, options);
    if (session) return session;
    failed(session);
  }
  return Error{reasons};
}

/// A session on another device than the one that was asked for.
class FallenBackSession : public InferenceSession {
 public:
  FallenBackSession(std::unique_ptr<InferenceSession> session, std::string reason)
      : session_(std::move(session)), reason_(std::move(reason)) {}
  Result<std::vector<Tensor>> run(const Tensor& input) override { return session_->run(input); }
  std::string device() const override {
    return fmt::format("{} (cuda was asked for: {})", session_->device(), reason_);
  }

 private:
  std::unique_ptr<InferenceSession> session_;
  std::string reason_;
};

/// `name` is what a warning calls the network.
SessionResult make_session(std::string_view onnx, InferenceOptions options,
                           const std::string& name) {
  if (options.device == Device::cpu) return make_cpu_session(onnx, options);
  if (options.backend == Backend::onednn) {
    if (options.device == Device::cuda) {
      return Error{"'device: cuda' needs 'backend: opencv', 'onnxruntime' or 'auto'"};
    }
    options.device = Device::cpu;
    return make_cpu_session(onnx, options);
  }
  SessionResult session = make_cuda_session(onnx, options);
  if (session) return session;
  const bool asked = options.device == Device::cuda;
  const std::string reason = session.error().message;
  options.device = Device::cpu;
  if (options.precision == Precision::float16) options.precision = Precision::automatic;
  session = make_cpu_session(onnx, options);
  if (!session || !asked) return session;
  log::warning("{}: is computed on the CPU instead of 'device: cuda': {}", name, reason);
  return std::unique_ptr<InferenceSession>(
      std::make_unique<FallenBackSession>(std::move(*session), reason));
}

/// Asks before each new size of input whether the network can be computed for it at all: libraries
/// find out by themselves, but in 32 bits.
class CheckedSession : public InferenceSession {
 public:
  CheckedSession(std::unique_ptr<InferenceSession> session, OnnxGraph graph)
      : session_(std::move(session)), graph_(std::move(graph)) {}

  Result<std::vector<Tensor>> run(const Tensor& input) override {
    if (input.shape != checked_) {
      const std::vector<std::int64_t> dims(input.shape.begin(), input.shape.end());
      if (auto fits = check_sizes(graph_, dims); !fits) {
        return Error{fmt::format("cannot take an input of {}: {}", format_shape(input.shape),
                                 fits.error().message)};
      }
      checked_ = input.shape;
    }
    return session_->run(input);
  }
  std::string device() const override { return session_->device(); }

 private:
  std::unique_ptr<InferenceSession> session_;
  OnnxGraph graph_;
  std::vector<int> checked_;
};

/// What its input is said to be must be one picture of three channels.
Result<void> check_input(const OnnxGraph& graph) {
  if (graph.inputs.size() != 1) {
    return Error{fmt::format("has {} inputs; only networks that take one picture are run",
                             graph.inputs.size())};
  }
  const std::vector<std::int64_t>& dims = graph.declared.find(graph.inputs.front())->second;
  if (dims.empty()) return {};  // says nothing
  if (dims.size() != 4) {
    return Error{
        fmt::format("takes an input of {} dimensions instead of pictures (batch, "
                    "channels, height, width)",
                    dims.size())};
  }
  if (dims[0] > 1) {
    return Error{fmt::format("was exported for batches of {0}; export it with batch 1", dims[0])};
  }
  if (dims[3] == 3 && dims[1] != 3) {
    return Error{"takes pictures with channels last; export it with channels first (NCHW)"};
  }
  if (dims[1] != 3 && dims[1] != -1) {
    return Error{fmt::format("takes pictures of {} channels instead of 3", dims[1])};
  }
  return {};
}

/// What the input will be like as far as file and options tell; empty when something stays open.
std::vector<std::int64_t> input_dims(const OnnxGraph& graph, const InferenceOptions& options) {
  std::vector<std::int64_t> dims = graph.declared.find(graph.inputs.front())->second;
  if (dims.empty()) dims.assign(4, -1);
  const std::array<std::int64_t, 4> wanted = {1, 3, options.input_height_px,
                                              options.input_width_px};
  for (std::size_t i = 0; i < dims.size(); ++i) {
    if (dims[i] == -1 && wanted[i] > 0) dims[i] = wanted[i];
  }
  if (std::find(dims.begin(), dims.end(), -1) != dims.end()) dims.clear();
  return dims;
}

/// The graph, when it can be computed.
Result<OnnxGraph> read_sound_graph(std::string_view bytes, const InferenceOptions& options) {
  if (auto complete = check_onnx(bytes); !complete) return complete.error();
  Result<OnnxGraph> graph = read_onnx(bytes);
  if (!graph) return Error{"cannot load it: " + graph.error().message};
  if (auto picture = check_input(*graph); !picture) return picture.error();
  if (auto fits = check_sizes(*graph, input_dims(*graph, options)); !fits) {
    return Error{"cannot load it: " + fits.error().message};
  }
  return graph;
}

/// Sizes stay, weights go: the libraries have their own.
OnnxGraph without_weights(OnnxGraph graph) {
  constexpr std::size_t kSmall = 64;  // scales and the like are read again
  for (auto& [name, tensor] : graph.constants) {
    if (tensor.floats.size() > kSmall) std::vector<float>().swap(tensor.floats);
  }
  return graph;
}

}  // namespace

std::string format_shape(const std::vector<int>& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

void InferenceOptions::describe(OptionTable& table) {
  table.add("backend", backend,
            "library that runs the network; auto: the quickest that can (oneDNN, else ONNX Runtime "
            "if its library is named, else OpenCV)");
  table.add("device", device,
            "cuda: the GPU, by an OpenCV or ONNX Runtime that was built with CUDA; where there is "
            "none the CPU, with a warning; auto: the same without one");
  table.add("precision", precision,
            "auto: bfloat16 where the processor multiplies matrices of it (AMX), else float32; "
            "bfloat16 and int8 need backend onednn, int8 also `ranges`, float16 device cuda");
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
  Result<OnnxGraph> graph = read_sound_graph(*bytes, options);
  if (!graph) return failure(graph.error().message);
  SessionResult session = make_session(*bytes, options, onnx_file.lexically_normal().string());
  if (!session) return failure(session.error().message);
  return std::unique_ptr<InferenceSession>(
      std::make_unique<CheckedSession>(std::move(*session), without_weights(std::move(*graph))));
}

}  // namespace ydd
