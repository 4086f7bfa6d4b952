// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "ydd/base/result.h"
#include "ydd/inference/network.h"

/// The inference libraries behind load_network(). Each makes a session of a complete ONNX file in
/// memory; the failure does not name the file. `options.device` is cpu or cuda here: what is asked
/// for is what they do or fail.
namespace ydd {

using SessionResult = Result<std::unique_ptr<InferenceSession>>;

/// Reference and fallback: reads every operator that OpenCV does.
SessionResult make_opencv_session(std::string_view onnx, const InferenceOptions& options);

/// Convolutional detectors without decoding in the graph, by oneDNN; fails on other operators, on
/// processors without AVX2, and where this build has no oneDNN.
SessionResult make_onednn_session(std::string_view onnx, const InferenceOptions& options);

/// Whatever ONNX Runtime reads; its shared library is looked for when the program runs, and so is
/// its CUDA provider.
SessionResult make_onnxruntime_session(std::string_view onnx, const InferenceOptions& options);

}  // namespace ydd
