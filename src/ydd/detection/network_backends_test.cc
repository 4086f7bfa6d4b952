// SPDX-License-Identifier: Apache-2.0
// Every back end computes the same network: on a small one made here, and on real weights where
// YDD_MODELS names them. YDD_ONNXRUNTIME names libonnxruntime.so.1 where ONNX Runtime is to be
// tried.
#include "ydd/inference/network_backends.h"

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/detection/boxes.h"
#include "ydd/detection/yolo_decode.h"
#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

std::vector<float> pattern(int width, int height, float scale) {
  std::vector<float> out;
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto fx = static_cast<float>(x);
        const auto fy = static_cast<float>(y);
        out.push_back(scale * (0.5F + 0.3F * std::sin(0.05F * fx + static_cast<float>(c)) +
                               0.2F * std::cos(0.07F * fy * static_cast<float>(c + 1))));
      }
    }
  }
  return out;
}

/// In row-major order whatever the session gives.
std::vector<float> row_major(const Tensor& t) {
  if (!t.channels_last) return {t.values.begin(), t.values.end()};
  const auto channels = static_cast<std::size_t>(t.shape[1]);
  const std::size_t cells = t.values.size() / channels;
  std::vector<float> out(t.values.size());
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t c = 0; c < channels; ++c) out[c * cells + i] = t.values[i * channels + c];
  }
  return out;
}

struct Answer {
  std::vector<int> shape;
  std::vector<float> values;
};

/// By falling size.
std::vector<Answer> answers(InferenceSession& session, int width, int height, float scale) {
  const std::vector<float> input = pattern(width, height, scale);
  const auto outputs = session.run({{1, 3, height, width}, input});
  EXPECT_TRUE(outputs.ok()) << outputs.error().message;
  std::vector<Answer> all;
  if (!outputs) return all;
  for (const Tensor& t : *outputs) all.push_back({t.shape, row_major(t)});
  std::sort(all.begin(), all.end(),
            [](const Answer& a, const Answer& b) { return a.values.size() > b.values.size(); });
  return all;
}

/// Largest difference, relative to one or to the value where that is larger.
float largest_difference(const std::vector<Answer>& a, const std::vector<Answer>& b) {
  EXPECT_EQ(a.size(), b.size());
  float worst = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    EXPECT_EQ(a[i].shape, b[i].shape);
    if (a[i].shape != b[i].shape) continue;
    for (std::size_t k = 0; k < a[i].values.size(); ++k) {
      const float size = std::max(1.0F, std::abs(b[i].values[k]));
      worst = std::max(worst, std::abs(a[i].values[k] - b[i].values[k]) / size);
    }
  }
  return worst;
}

std::unique_ptr<InferenceSession> reference(const std::string& onnx) {
  auto session = make_opencv_session(onnx, {.backend = Backend::opencv});
  EXPECT_TRUE(session.ok()) << session.error().message;
  return session ? std::move(*session) : nullptr;
}

TEST(NetworkBackends, OneDnnComputesWhatOpenCvComputes) {
  const std::string model = testing_onnx::miniature_yolo_model();
  auto quick = make_onednn_session(model, {.precision = Precision::float32});
  if (!quick) GTEST_SKIP() << quick.error().message;
  const auto slow = reference(model);
  ASSERT_NE(slow, nullptr);
  for (const auto& [width, height] : {std::pair{96, 64}, std::pair{64, 96}, std::pair{160, 128}}) {
    const auto expected = answers(*slow, width, height, 1);
    ASSERT_EQ(expected.size(), 3U);
    EXPECT_LT(largest_difference(answers(**quick, width, height, 1), expected), 1e-4F)
        << width << " x " << height;
  }
}

TEST(NetworkBackends, OneDnnRepeatsItselfAndTakesThreads) {
  const std::string model = testing_onnx::miniature_yolo_model();
  auto one = make_onednn_session(model, {});
  auto two = make_onednn_session(model, {.threads = 2});
  if (!one) GTEST_SKIP() << one.error().message;
  const auto first = answers(**one, 96, 64, 1);
  EXPECT_EQ(largest_difference(answers(**one, 96, 64, 1), first), 0.0F);
  EXPECT_LT(largest_difference(answers(**two, 96, 64, 1), first), 1e-2F);
}

TEST(NetworkBackends, Bfloat16IsCloseEnough) {
  const std::string model = testing_onnx::miniature_yolo_model();
  auto quick = make_onednn_session(model, {.precision = Precision::bfloat16});
  if (!quick) GTEST_SKIP() << quick.error().message;
  const auto slow = reference(model);
  ASSERT_NE(slow, nullptr);
  // Eight bits of mantissa through a dozen layers.
  EXPECT_LT(largest_difference(answers(**quick, 96, 64, 1), answers(*slow, 96, 64, 1)), 0.1F);
}

TEST(NetworkBackends, OnnxRuntimeComputesWhatOpenCvComputes) {
  const char* library = std::getenv("YDD_ONNXRUNTIME");
  InferenceOptions options;
  if (library != nullptr) options.onnxruntime = library;
  const std::string model = testing_onnx::miniature_yolo_model();
  auto session = make_onnxruntime_session(model, options);
  if (!session && library == nullptr) GTEST_SKIP() << session.error().message;
  ASSERT_TRUE(session.ok()) << session.error().message;
  const auto slow = reference(model);
  ASSERT_NE(slow, nullptr);
  EXPECT_LT(largest_difference(answers(**session, 96, 64, 1), answers(*slow, 96, 64, 1)), 1e-4F);
  const std::vector<float> wrong(std::size_t{7} * 32 * 32);
  const auto refused = (*session)->run({{1, 7, 32, 32}, wrong});
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("cannot take an input of [1, 7, 32, 32]"),
            std::string::npos);
}

/// Real weights: heads after the sigmoid, so that 1e-3 is a thousandth of a probability.
TEST(NetworkBackends, RealWeightsGiveTheSameBoxes) {
  const char* folder = std::getenv("YDD_MODELS");
  if (folder == nullptr) GTEST_SKIP() << "set YDD_MODELS to the folder with the network weights";
  struct Weights {
    const char* file;
    float scale;
  };
  for (const Weights& weights : {Weights{"yolov5n_coco_anysize.onnx", 1.0F},
                                 Weights{"yolox_n_body_head_hand_anysize.onnx", 255.0F}}) {
    const auto bytes = read_file(std::filesystem::path(folder) / weights.file);
    if (!bytes) GTEST_SKIP() << bytes.error().message;
    const auto slow = reference(*bytes);
    ASSERT_NE(slow, nullptr);
    const auto expected = answers(*slow, 320, 256, weights.scale);
    for (const Precision precision : {Precision::float32, Precision::bfloat16}) {
      auto quick = make_onednn_session(*bytes, {.precision = precision});
      if (!quick) continue;
      const float allowed = precision == Precision::float32 ? 1e-3F : 0.35F;
      EXPECT_LT(largest_difference(answers(**quick, 320, 256, weights.scale), expected), allowed)
          << weights.file << " " << to_string(precision);
    }
  }
}

}  // namespace
}  // namespace ydd
