// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/layers.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

using testing_onnx::GraphWriter;

LayerGraph layers_of(const std::string& model) {
  auto graph = read_onnx(model);
  EXPECT_TRUE(graph.ok()) << graph.error().message;
  auto layers = make_layers(std::move(*graph));
  EXPECT_TRUE(layers.ok()) << layers.error().message;
  return std::move(*layers);
}

std::string translation_failure(const std::string& model) {
  auto graph = read_onnx(model);
  if (!graph) return graph.error().message;
  auto layers = make_layers(std::move(*graph));
  return layers ? "translated" : layers.error().message;
}

TEST(Layers, SigmoidAndProductJoinTheirConvolution) {
  GraphWriter g;
  const auto layers = layers_of(g.finish({g.silu(g.convolution("images", 3, 4, 3))}));
  ASSERT_EQ(layers.layers.size(), 1U);
  EXPECT_EQ(layers.layers[0].activation, Activation::silu);
  EXPECT_EQ(layers.layers[0].weights.dims, (std::vector<std::int64_t>{4, 3, 3, 3}));
  EXPECT_EQ(layers.outputs, std::vector<int>{layers.layers[0].output});
}

TEST(Layers, AConvolutionThatOthersReadBeforeItsActivationStays) {
  GraphWriter g;
  const std::string conv = g.convolution("images", 3, 4, 1);
  const auto layers = layers_of(g.finish({g.silu(conv), conv}));
  ASSERT_EQ(layers.layers.size(), 2U);
  EXPECT_EQ(layers.layers[0].activation, Activation::none);
  EXPECT_EQ(layers.layers[1].kind, LayerKind::activation);
  EXPECT_EQ(layers.layers[1].activation, Activation::silu);
}

TEST(Layers, ASumJoinsItsConvolutionUnlessTheOtherPartIsReadLater) {
  GraphWriter g;
  const std::string x = g.convolution("images", 3, 4, 1);
  const std::string inner = g.silu(g.convolution(g.convolution(x, 4, 4, 1), 4, 4, 3));
  const auto fused = layers_of(g.finish({g.node("Add", {x, inner})}));
  ASSERT_EQ(fused.layers.size(), 3U);
  EXPECT_EQ(fused.layers[2].residual, fused.layers[0].output);
  GraphWriter h;
  const std::string y = h.convolution("images", 3, 4, 1);
  const std::string sum =
      h.node("Add", {y, h.silu(h.convolution(h.convolution(y, 4, 4, 1), 4, 4, 3))});
  const auto apart = layers_of(h.finish({h.concat({sum, y})}));
  ASSERT_EQ(apart.layers.size(), 5U);
  EXPECT_EQ(apart.layers[3].kind, LayerKind::add);
}

TEST(Layers, AConvolutionNeverAddsToWhatItReads) {
  GraphWriter g;
  const std::string x = g.convolution("images", 3, 4, 1);
  const auto layers = layers_of(g.finish({g.node("Add", {x, g.convolution(x, 4, 4, 3)})}));
  ASSERT_EQ(layers.layers.size(), 3U);
  EXPECT_FALSE(layers.layers[1].residual.has_value());
}

TEST(Layers, AValueReadBetweenConvolutionAndSumIsNotOverwritten) {
  GraphWriter g;
  const std::string x = g.convolution("images", 3, 4, 1);
  const std::string inner = g.convolution(x, 4, 4, 3);
  const std::string pooled = g.pool(x, 3);
  const auto layers = layers_of(g.finish({g.node("Add", {inner, x}), pooled}));
  EXPECT_TRUE(std::any_of(layers.layers.begin(), layers.layers.end(),
                          [](const Layer& l) { return l.kind == LayerKind::add; }));
}

TEST(Layers, LastUsesTellWhenAValueIsDone) {
  GraphWriter g;
  const std::string a = g.convolution("images", 3, 4, 1);
  const std::string b = g.pool(a, 3);
  const auto layers = layers_of(g.finish({g.concat({a, b})}));
  const std::vector<int> last = last_uses(layers);
  EXPECT_EQ(last[0], 0);
  EXPECT_EQ(last[static_cast<std::size_t>(layers.layers[0].output)], 2);
  EXPECT_EQ(last[static_cast<std::size_t>(layers.layers[2].output)], 3) << "an output";
}

TEST(Layers, WhatIsNotUnderstoodIsNamed) {
  GraphWriter g;
  EXPECT_EQ(translation_failure(g.finish({g.node("Tanh", {"images"})})),
            "operator Tanh is not one of those");
  GraphWriter h;
  EXPECT_EQ(translation_failure(h.finish(
                {h.node("Concat", {"images", "images"}, GraphWriter::integer("axis", 2))})),
            "operator Concat along another axis than channels");
  GraphWriter i;
  EXPECT_EQ(translation_failure(i.finish({i.node("Mul", {"images", i.constant({2})})})),
            "operator Mul of constants");
  GraphWriter j;
  EXPECT_EQ(translation_failure(j.finish(
                {j.node("Resize", {"images", j.constant({}), j.constant({1, 1, 1.5F, 1.5F})})})),
            "operator Resize by a factor that is not whole");
}

TEST(OnnxGraph, DamageIsAnErrorWhereverItIs) {
  const std::string whole = testing_onnx::miniature_yolo_model();
  for (std::size_t at = 4; at < whole.size(); at += 7) {
    std::string broken = whole;
    for (std::size_t i = at; i < std::min(at + 3, broken.size()); ++i) broken[i] = '\xFF';
    auto graph = read_onnx(broken);
    if (graph) (void)make_layers(std::move(*graph)).ok();  // either is fine, a crash is not
  }
  EXPECT_FALSE(read_onnx(whole.substr(0, whole.size() / 2)).ok());
}

}  // namespace
}  // namespace ydd
