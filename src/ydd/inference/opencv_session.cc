// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "ydd/inference/network_backends.h"

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

class OpenCvSession : public InferenceSession {
 public:
  OpenCvSession(const cv::dnn::Net& net, const InferenceOptions& options)  // a handle
      : net_(net),
        output_names_(net_.getUnconnectedOutLayersNames()),
        threads_(options.threads),
        device_(to_string(options.device)) {}

  Result<std::vector<Tensor>> run(const Tensor& input) override {
    const QuietOpenCv quiet;
    const Threads threads(threads_);
    try {
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
  std::vector<cv::String> output_names_;
  int threads_;
  std::string device_;
  std::vector<cv::Mat> outputs_;  // keeps alive what views() points to
};

struct Target {
  cv::dnn::Backend backend;
  cv::dnn::Target target;
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

}  // namespace

SessionResult make_opencv_session(std::string_view onnx, const InferenceOptions& options) {
  const QuietOpenCv quiet;
  try {
    const Result<Target> chosen = choose_target(options);
    if (!chosen) return chosen.error();
    cv::dnn::Net net = cv::dnn::readNetFromONNX(onnx.data(), onnx.size());
    if (net.empty()) return Error{"holds no network"};
    net.setPreferableBackend(chosen->backend);
    net.setPreferableTarget(chosen->target);
    return std::unique_ptr<InferenceSession>(std::make_unique<OpenCvSession>(net, options));
  } catch (const std::exception& e) {
    return Error{fmt::format("OpenCV {} cannot load it: {}", CV_VERSION, reason_of(e))};
  }
}

}  // namespace ydd
