// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/onnx_input_size.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ydd/inference/network_backends.h"
#include "ydd/inference/onnx_graph.h"
#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

const std::vector<int> kShape = {1, 3, 64, 96};

std::vector<std::vector<float>> answers(std::string_view onnx, const std::vector<int>& shape) {
  std::vector<float> input(static_cast<std::size_t>(3 * shape[2] * shape[3]));
  for (std::size_t i = 0; i < input.size(); ++i) input[i] = static_cast<float>(i % 251) / 250.0F;
  const auto session = make_opencv_session(onnx, {.backend = Backend::opencv});
  if (!session) return {};
  const auto outputs = (*session)->run({shape, input});
  if (!outputs) return {};
  std::vector<std::vector<float>> values;
  for (const Tensor& t : *outputs) values.emplace_back(t.values.begin(), t.values.end());
  return values;
}

TEST(OnnxInputSize, IsSaidOfTheInputAlone) {
  const std::string model = testing_onnx::miniature_yolo_model();
  const Result<OnnxGraph> before = read_onnx(model);
  ASSERT_TRUE(before.ok());
  const std::string input = before->inputs.front();
  const Result<std::string> sized = with_input_size(model, input, kShape);
  ASSERT_TRUE(sized.ok()) << sized.error().message;
  const Result<OnnxGraph> after = read_onnx(*sized);
  ASSERT_TRUE(after.ok()) << after.error().message;
  EXPECT_EQ(after->declared.find(input)->second, (std::vector<std::int64_t>{1, 3, 64, 96}));
  EXPECT_NE(before->declared.find(input)->second, after->declared.find(input)->second);
  EXPECT_EQ(before->outputs, after->outputs);
  ASSERT_EQ(before->constants.size(), after->constants.size());
  for (const auto& [name, tensor] : before->constants) {
    EXPECT_EQ(tensor.floats, after->constants.find(name)->second.floats) << name;
  }
  // Another value's name: nothing changes.
  EXPECT_EQ(with_input_size(model, "no such input", kShape).value(), model);
}

TEST(OnnxInputSize, AnswersStayTheSame) {
  const std::string model = testing_onnx::miniature_yolo_model();
  const std::string input = read_onnx(model)->inputs.front();
  const auto expected = answers(model, kShape);
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(answers(with_input_size(model, input, kShape).value(), kShape), expected);
}

TEST(OnnxInputSize, CutOffFilesFail) {
  const std::string model = testing_onnx::single_operator_model("Tanh");
  std::size_t failed = 0;
  for (std::size_t length = 1; length < model.size(); ++length) {
    failed += with_input_size(model.substr(0, length), "images", kShape).ok() ? 0U : 1U;
  }
  // What is cut between two fields of the model is a whole message.
  EXPECT_GE(failed, model.size() - 4);
}

}  // namespace
}  // namespace ydd
