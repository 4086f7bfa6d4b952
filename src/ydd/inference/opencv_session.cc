// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "ydd/inference/network_backends.h"
#include "ydd/inference/onnx_graph.h"
#include "ydd/inference/onnx_input_size.h"

namespace ydd {
namespace {

/// OpenCV writes to standard error what it throws as well; the level is process-wide, so it is put
/// back.
class QuietOpenCv {
 public:
  QuietOpenCv() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(before_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

/// The reason in one line. `what()` of OpenCV's own has several, with source paths; damaged files
/// also make it ask for vectors without end.
std::string reason_of(const std::exception& e) {
  const auto* const own = dynamic_cast<const cv::Exception*>(&e);
  std::string reason = own == nullptr ? e.what() : own->err;
  if (reason.empty()) reason = "unknown error";
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  constexpr std::size_t kLongest = 300;
  if (reason.size() > kLongest) reason = reason.substr(0, kLongest) + "...";
  return reason;
}

/// OpenCV's pool is process-wide as well.
class Threads {
 public:
  explicit Threads(int count) : before_(cv::getNumThreads()) { cv::setNumThreads(count); }
  ~Threads() { cv::setNumThreads(before_); }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

 private:
  int before_;
};

struct Target {
  cv::dnn::Backend backend;
  cv::dnn::Target target;
};

cv::dnn::Net read_net(std::string_view onnx, const Target& target) {
  cv::dnn::Net net = cv::dnn::readNetFromONNX(onnx.data(), onnx.size());
  if (net.empty()) throw std::runtime_error("holds no network");
  net.setPreferableBackend(target.backend);
  net.setPreferableTarget(target.target);
  return net;
}

/// A network that OpenCV can read for one size of input at a time: 4.10 computes all sizes
/// while it reads, and takes those that the file leaves open as 1.
struct OfOneSize {
  std::string onnx, input;
  std::vector<int> shape;  ///< that it was read for last

  cv::dnn::Net read(const std::vector<int>& wanted, const Target& target) {
    const Result<std::string> sized = with_input_size(onnx, input, wanted);
    if (!sized) throw std::runtime_error(sized.error().message);
    cv::dnn::Net net = read_net(*sized, target);
    shape = wanted;
    return net;
  }
};

class OpenCvSession : public InferenceSession {
 public:
  OpenCvSession(const cv::dnn::Net& net, std::optional<OfOneSize> of_one_size, const Target& target,
                const InferenceOptions& options)  // a handle
      : net_(net),
        of_one_size_(std::move(of_one_size)),
        target_(target),
        output_names_(net_.getUnconnectedOutLayersNames()),
        threads_(options.threads),
        device_(to_string(options.device)) {}

  Result<std::vector<Tensor>> run(const Tensor& input) override {
    const QuietOpenCv quiet;
    const Threads threads(threads_);
    try {
      if (of_one_size_ && of_one_size_->shape != input.shape) {
        net_ = of_one_size_->read(input.shape, target_);
      }
      // OpenCV only reads its input, but a Mat cannot say so.
      net_.setInput(cv::Mat(input.shape, CV_32F, const_cast<float*>(input.values.data())));
      outputs_.clear();
      net_.forward(outputs_, output_names_);
    } catch (const std::exception& e) {
      return Error{
          fmt::format("cannot take an input of {}: {}", format_shape(input.shape), reason_of(e))};
    }
    return views();
  }
  std::string device() const override { return device_; }

 private:
  Result<std::vector<Tensor>> views() const {
    std::vector<Tensor> tensors;
    for (const cv::Mat& mat : outputs_) {
      if (mat.type() != CV_32F || !mat.isContinuous()) {
        return Error{"gives something else than 32-bit floats"};
      }
      tensors.push_back(
          {std::vector<int>(mat.size.p, mat.size.p + mat.dims), {mat.ptr<float>(), mat.total()}});
    }
    return tensors;
  }

  cv::dnn::Net net_;
  std::optional<OfOneSize> of_one_size_;
  Target target_;
  std::vector<cv::String> output_names_;
  int threads_;
  std::string device_;
  std::vector<cv::Mat> outputs_;  // keeps alive what views() points to
};

bool is_built_with_cuda() {
  const std::string& built = cv::getBuildInformation();
  const std::size_t line = built.find("NVIDIA CUDA:");
  return line != std::string::npos &&
         built.substr(line, built.find('\n', line) - line).find("YES") != std::string::npos;
}

Result<Target> choose_target(const InferenceOptions& options) {
  const bool half = options.precision == Precision::float16;
  if (options.precision == Precision::bfloat16 || options.precision == Precision::int8) {
    return Error{fmt::format("precision {} needs 'backend: onednn'", to_string(options.precision))};
  }
  if (options.device == Device::cpu) {
    if (half) return Error{"precision float16 needs 'device: cuda'"};
    return Target{cv::dnn::DNN_BACKEND_OPENCV, cv::dnn::DNN_TARGET_CPU};
  }
  if (!is_built_with_cuda()) {
    return Error{fmt::format("OpenCV {} was built without CUDA", CV_VERSION)};
  }
  const cv::dnn::Target target = half ? cv::dnn::DNN_TARGET_CUDA_FP16 : cv::dnn::DNN_TARGET_CUDA;
  const auto targets = cv::dnn::getAvailableTargets(cv::dnn::DNN_BACKEND_CUDA);
  if (std::find(targets.begin(), targets.end(), target) == targets.end()) {
    return Error{fmt::format("OpenCV {} finds no GPU that it can use{}", CV_VERSION,
                             half ? " with float16" : "")};
  }
  return Target{cv::dnn::DNN_BACKEND_CUDA, target};
}

/// The network for one size at a time, if it takes inputs of any; a size to begin with is that of
/// the options, or the smallest that ours is used with.
std::optional<OfOneSize> of_one_size(std::string_view onnx) {
  const Result<OnnxGraph> graph = read_onnx(onnx);
  if (!graph || graph->inputs.size() != 1) return std::nullopt;
  const auto declared = graph->declared.find(graph->inputs.front());
  if (declared == graph->declared.end()) return std::nullopt;
  const std::vector<std::int64_t>& dims = declared->second;
  if (std::find(dims.begin(), dims.end(), -1) == dims.end()) return std::nullopt;
  return OfOneSize{std::string(onnx), graph->inputs.front(), {}};
}

std::vector<int> first_shape(const InferenceOptions& options) {
  const bool known = options.input_height_px > 0 && options.input_width_px > 0;
  return {1, 3, known ? options.input_height_px : 256, known ? options.input_width_px : 320};
}

}  // namespace

SessionResult make_opencv_session(std::string_view onnx, const InferenceOptions& options) {
  const QuietOpenCv quiet;
  const auto session = [&](const cv::dnn::Net& net, std::optional<OfOneSize> sized,
                           const Target& target) -> SessionResult {
    return std::unique_ptr<InferenceSession>(
        std::make_unique<OpenCvSession>(net, std::move(sized), target, options));
  };
  const Result<Target> target = choose_target(options);
  if (!target) return target.error();
  std::string reason;
  try {
    return session(read_net(onnx, *target), std::nullopt, *target);
  } catch (const std::exception& e) {
    reason = reason_of(e);
  }
  if (std::optional<OfOneSize> sized = of_one_size(onnx)) {
    try {
      const cv::dnn::Net net = sized->read(first_shape(options), *target);
      return session(net, std::move(sized), *target);
    } catch (const std::exception&) {  // the first reason is the one to tell
    }
  }
  return Error{fmt::format("OpenCV {} cannot load it: {}", CV_VERSION, reason)};
}

}  // namespace ydd
