// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/network.h"

#include <unistd.h>

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
namespace onnx = testing_onnx;

class NetworkFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("ydd_network_{}_{}", ::getpid(),
                          testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file() const { return folder_ / "model.onnx"; }

  /// The one line that loading `content` fails with, and nothing on standard error.
  std::string failure_of(const std::string& content, const InferenceOptions& options = {}) const {
    onnx::write(file(), content);
    testing::internal::CaptureStderr();
    const auto session = load_network(file(), options);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    if (session.ok()) return "loaded";
    EXPECT_EQ(session.error().message.find('\n'), std::string::npos);
    EXPECT_THAT(session.error().message, HasSubstr("model.onnx: "));
    return session.error().message;
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(NetworkFile, RunsAtAnySize) {
  onnx::write(file(), onnx::colour_spotter_model());
  auto session = load_network(file(), {});
  ASSERT_TRUE(session.ok()) << session.error().message;
  for (const int width : {64, 96, 64}) {
    const std::vector<float> red_plane_last = [&] {
      std::vector<float> blob(std::size_t{3} * 32 * width, 0.0F);
      std::fill(blob.end() - 32 * width, blob.end(), 255.0F);
      return blob;
    }();
    const auto outputs = (*session)->run({{1, 3, 32, width}, red_plane_last});
    ASSERT_TRUE(outputs.ok()) << outputs.error().message;
    ASSERT_EQ(outputs->size(), 3U);
    bool seen = false;
    for (const Tensor& t : *outputs) {
      if (t.shape != std::vector<int>{1, 8, 4, width / 8}) continue;
      seen = true;
      const std::size_t plane = std::size_t{4} * (width / 8);
      ASSERT_EQ(t.values.size(), 8 * plane);
      const auto value = [&](std::size_t channel, std::size_t cell) {
        return t.values[t.channels_last ? cell * 8 + channel : channel * plane + cell];
      };
      EXPECT_NEAR(value(4, 0), 1.0F, 4e-3);
      EXPECT_NEAR(value(5, 0), 0.0F, 4e-3);
      EXPECT_NEAR(value(7, plane - 1), 1.0F, 4e-3);
    }
    EXPECT_TRUE(seen);
  }
}

TEST_F(NetworkFile, AnInputOfAnotherFormIsAnErrorNotACrash) {
  onnx::write(file(), onnx::colour_spotter_model());
  auto session = load_network(file(), {});
  ASSERT_TRUE(session.ok());
  const std::vector<float> blob(std::size_t{7} * 32 * 32);
  testing::internal::CaptureStderr();
  const auto outputs = (*session)->run({{1, 7, 32, 32}, blob});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(outputs.ok());
  EXPECT_THAT(outputs.error().message, HasSubstr("cannot take an input of [1, 7, 32, 32]"));
  EXPECT_EQ(outputs.error().message.find('\n'), std::string::npos);
}

TEST_F(NetworkFile, AMissingFileIsNamed) {
  const auto session = load_network(file(), {});
  ASSERT_FALSE(session.ok());
  EXPECT_THAT(session.error().message, HasSubstr("model.onnx: cannot be opened"));
}

TEST_F(NetworkFile, EveryTruncationIsRecognised) {
  const std::string whole = onnx::colour_spotter_model();
  for (std::size_t size = 2; size < whole.size(); size += size < 64 ? 1 : 37) {
    ASSERT_THAT(failure_of(whole.substr(0, size)), HasSubstr("truncated")) << size;
  }
  ASSERT_THAT(failure_of(whole.substr(0, whole.size() - 1)), HasSubstr("truncated"));
}

TEST_F(NetworkFile, WhatIsNotANetworkSaysSo) {
  EXPECT_THAT(failure_of(""), HasSubstr("truncated"));
  EXPECT_THAT(failure_of("version https://git-lfs.github.com/spec/v1\n"), HasSubstr("not an ONNX"));
  EXPECT_THAT(failure_of("<html>404</html>"), HasSubstr("not an ONNX"));
  EXPECT_THAT(failure_of("\x89PNG\r\n\x1a\n"), HasSubstr("not an ONNX"));
}

TEST_F(NetworkFile, DamageInsideTheGraphAndUnknownOperatorsAreOneLine) {
  std::string broken = onnx::colour_spotter_model();
  for (std::size_t i = 8; i < 60; ++i) broken[i] = '\xFF';
  EXPECT_THAT(failure_of(broken), HasSubstr("cannot load it"));
  EXPECT_THAT(failure_of(onnx::single_operator_model("NoSuchOperator")),
              HasSubstr("cannot load it"));
}

TEST_F(NetworkFile, ABackendThatIsNotThereIsNamed) {
  const std::string model = onnx::colour_spotter_model();
  EXPECT_THAT(failure_of(model, {.backend = Backend::opencv, .precision = Precision::float16}),
              HasSubstr("float16 needs 'device: cuda'"));
  EXPECT_THAT(failure_of(model, {.backend = Backend::onednn, .device = Device::cuda}),
              HasSubstr("'device: cuda' needs 'backend: opencv', 'onnxruntime' or 'auto'"));
  EXPECT_THAT(failure_of(model, {.backend = Backend::onnxruntime, .onnxruntime = "/no/such.so"}),
              HasSubstr("ONNX Runtime cannot be loaded: /no/such.so"));
  EXPECT_THAT(failure_of(model, {.backend = Backend::onnxruntime, .onnxruntime = "libm.so.6"}),
              HasSubstr("is not ONNX Runtime"));
}

TEST_F(NetworkFile, WithoutAGpuTheCpuComputesAndOneLineSaysSo) {
  onnx::write(file(), onnx::colour_spotter_model());
  const std::vector<float> blob = [] {
    std::vector<float> values(std::size_t{3} * 32 * 64);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 251);
    return values;
  }();
  const Tensor input{{1, 3, 32, 64}, blob};
  struct Answer {
    std::string device, said;
    std::vector<std::vector<float>> values;
  };
  const auto answer = [&](const InferenceOptions& options) {
    testing::internal::CaptureStderr();
    auto session = load_network(file(), options);
    Answer out{"", testing::internal::GetCapturedStderr(), {}};
    EXPECT_TRUE(session.ok()) << session.error().message;
    if (!session) return out;
    out.device = (*session)->device();
    for (const Tensor& t : *(*session)->run(input)) {
      out.values.emplace_back(t.values.begin(), t.values.end());
    }
    return out;
  };
  const Answer cpu = answer({});
  EXPECT_EQ(cpu.device, "cpu");
  const Answer automatic = answer({.device = Device::automatic});
  if (automatic.device == "cuda") GTEST_SKIP() << "there is a GPU";
  EXPECT_EQ(automatic.device, "cpu");
  EXPECT_EQ(automatic.said, "");
  for (const Precision precision : {Precision::automatic, Precision::float16}) {
    const Answer asked = answer({.device = Device::cuda, .precision = precision});
    EXPECT_THAT(asked.device, StartsWith("cpu (cuda was asked for: OpenCV "));
    EXPECT_THAT(asked.said, HasSubstr("model.onnx: is computed on the CPU instead of 'device: "
                                      "cuda': OpenCV "));
    EXPECT_EQ(std::count(asked.said.begin(), asked.said.end(), '\n'), 1) << asked.said;
    EXPECT_EQ(asked.values, cpu.values);
  }
}

TEST_F(NetworkFile, WhatOneDnnDoesNotKnowGoesToOpenCv) {
  const std::string model = onnx::single_operator_model("Tanh");
  const std::string refused = failure_of(model, {.backend = Backend::onednn});
  if (refused.find("no oneDNN") != std::string::npos) GTEST_SKIP() << refused;
  EXPECT_THAT(refused, HasSubstr("oneDNN cannot load it: operator Tanh"));
  EXPECT_EQ(failure_of(model), "loaded");
}

}  // namespace
}  // namespace ydd
