// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/network.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "ydd/base/files.h"

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

/// The reason in one line. `what()` has several, with source paths of OpenCV.
std::string reason_of(const cv::Exception& e) {
  std::string reason = e.err.empty() ? "unknown error" : e.err;
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  constexpr std::size_t kLongest = 300;
  if (reason.size() > kLongest) reason = reason.substr(0, kLongest) + "...";
  return reason;
}

class OpenCvSession : public InferenceSession {
 public:
  explicit OpenCvSession(const cv::dnn::Net& net)  // a handle
      : net_(net), output_names_(net_.getUnconnectedOutLayersNames()) {}

  Result<std::vector<Tensor>> run(const Tensor& input) override {
    const QuietOpenCv quiet;
    try {
      // OpenCV only reads its input, but a Mat cannot say so.
      net_.setInput(cv::Mat(input.shape, CV_32F, const_cast<float*>(input.values.data())));
      outputs_.clear();
      net_.forward(outputs_, output_names_);
    } catch (const cv::Exception& e) {
      return Error{
          fmt::format("cannot take an input of {}: {}", format_shape(input.shape), reason_of(e))};
    }
    return views();
  }

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
  std::vector<cv::Mat> outputs_;  // keeps alive what views() points to
};

Result<void> choose_backend(cv::dnn::Net& net, const InferenceOptions& options) {
  if (options.backend == "cpu") {
    if (options.fp16) return Error{"fp16 needs 'backend: cuda'"};
    net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    return {};
  }
  const cv::dnn::Target target =
      options.fp16 ? cv::dnn::DNN_TARGET_CUDA_FP16 : cv::dnn::DNN_TARGET_CUDA;
  const auto targets = cv::dnn::getAvailableTargets(cv::dnn::DNN_BACKEND_CUDA);
  if (std::find(targets.begin(), targets.end(), target) == targets.end()) {
    return Error{fmt::format(
        "'backend: cuda'{} is not available: this OpenCV was built without CUDA or finds no such "
        "GPU; use 'backend: cpu'",
        options.fp16 ? " with fp16" : "")};
  }
  net.setPreferableBackend(cv::dnn::DNN_BACKEND_CUDA);
  net.setPreferableTarget(target);
  return {};
}

}  // namespace

std::string format_shape(const std::vector<int>& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

void InferenceOptions::describe(OptionTable& table) {
  table.add("backend", backend, {"cpu", "cuda"},
            "where the network runs; cuda needs an OpenCV that was built with it");
  table.add("fp16", fp16, "half precision: quicker on a GPU, needs backend cuda");
}

Result<std::unique_ptr<InferenceSession>> load_network(const std::filesystem::path& onnx_file,
                                                       const InferenceOptions& options) {
  const Result<std::string> bytes = read_file(onnx_file);
  if (!bytes) return bytes.error();
  const auto failure = [&](const std::string& reason) {
    return Error{fmt::format("{}: {}", onnx_file.string(), reason)};
  };
  if (auto complete = check_onnx(*bytes); !complete) return failure(complete.error().message);
  const QuietOpenCv quiet;
  try {
    cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes->data(), bytes->size());
    if (net.empty()) return failure("holds no network");
    if (auto chosen = choose_backend(net, options); !chosen) {
      return failure(chosen.error().message);
    }
    return std::unique_ptr<InferenceSession>(std::make_unique<OpenCvSession>(net));
  } catch (const cv::Exception& e) {
    return failure(fmt::format("OpenCV {} cannot load it: {}", CV_VERSION, reason_of(e)));
  }
}

}  // namespace ydd
