// SPDX-License-Identifier: Apache-2.0
// What oneDNN chooses on other processors than this one: it can be held to fewer instructions, but
// only before its first use in a process, so that each case runs in a process of its own.
#if defined(YDD_WITH_ONEDNN) && defined(__x86_64__)
#include "ydd/inference/onednn_plan.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <dnnl.hpp>

#include "ydd/base/files.h"
#include "ydd/inference/network_backends.h"
#include "ydd/inference/onednn_kernels.h"
#include "ydd/inference/onednn_versions.h"
#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

struct ForcedIsa {
  const char* name;
  dnnl::cpu_isa isa;
};

constexpr ForcedIsa kIsas[] = {{"sse41", dnnl::cpu_isa::sse41},
                               {"avx", dnnl::cpu_isa::avx},
                               {"avx2", dnnl::cpu_isa::avx2},
                               {"avx512_core", dnnl::cpu_isa::avx512_core},
                               {"avx512_core_vnni", dnnl::cpu_isa::avx512_core_vnni},
                               {"all", onednn::kEveryIsa}};

[[noreturn]] void end_child(const std::string& complaint) {
  std::fputs(complaint.c_str(), stderr);
  std::_Exit(complaint.empty() ? 0 : 1);
}

/// Ends the process: 0 when the plan holds no reference kernel and the outputs are OpenCV's.
[[noreturn]] void check_plan(const std::string& onnx, dnnl::cpu_isa isa,
                             const std::vector<int>& shape, float allowed) {
  if (dnnl::set_max_cpu_isa(isa) != dnnl::status::success) end_child("cannot force this");
  Result<OnnxGraph> graph = read_onnx(onnx);
  Result<LayerGraph> layers =
      graph ? make_layers(std::move(*graph)) : Result<LayerGraph>(graph.error());
  if (!layers) end_child(layers.error().message);
  OnednnPlan plan(*layers, shape, {});
  if (plan.implementations().size() < 10) end_child("a plan of almost nothing");
  for (const std::string& name : plan.implementations()) {
    if (is_reference(name)) end_child("reference kernel: " + name);
  }
  std::vector<float> input(static_cast<std::size_t>(3 * shape[2] * shape[3]));
  for (std::size_t i = 0; i < input.size(); ++i) {
    input[i] = static_cast<float>((i * 2654435761U) % 1000U) / 1000.0F;
  }
  auto slow = make_opencv_session(onnx, {.backend = Backend::opencv});
  if (!slow) end_child(slow.error().message);
  auto expected = (*slow)->run({shape, input});
  if (!expected) end_child(expected.error().message);
  const std::vector<Tensor> found = plan.run({shape, input});
  if (found.size() != expected->size()) end_child("another number of outputs");
  for (const Tensor& t : found) {
    // OpenCV sorts its outputs otherwise: the one of this size.
    const auto same = std::find_if(expected->begin(), expected->end(),
                                   [&](const Tensor& e) { return e.shape == t.shape; });
    if (same == expected->end()) end_child("an output of another size");
    const auto channels = static_cast<std::size_t>(t.shape[1]);
    const std::size_t cells = t.values.size() / channels;
    for (std::size_t i = 0; i < t.values.size(); ++i) {
      const float e = same->values[(i % channels) * cells + i / channels];
      const float tolerance = allowed * std::max(1.0F, std::abs(e));
      if (!(std::abs(t.values[i] - e) <= tolerance)) {
        end_child(fmt::format("value {} is {} instead of {}", i, t.values[i], e));
      }
    }
  }
  end_child("");
}

class OnednnPlanOn : public testing::TestWithParam<ForcedIsa> {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }

  static void expect_sound(const std::string& onnx, int width, int height, float allowed) {
    EXPECT_EXIT(check_plan(onnx, GetParam().isa, {1, 3, height, width}, allowed),
                testing::ExitedWithCode(0), "");
  }
};

TEST_P(OnednnPlanOn, MiniatureHasNoReferenceKernel) {
  expect_sound(testing_onnx::miniature_yolo_model(), 96, 64, 1e-4F);
}

TEST_P(OnednnPlanOn, ClonesNetworkHasNoReferenceKernel) {
  const auto onnx = read_file(std::filesystem::path(YDD_SOURCE_DIR) / "models/ydd_n.onnx");
  ASSERT_TRUE(onnx.ok()) << onnx.error().message;
  expect_sound(*onnx, 320, 256, 1e-3F);
}

TEST_P(OnednnPlanOn, OtherNetworksHaveNoReferenceKernel) {
  const char* folder = std::getenv("YDD_MODELS");
  if (folder == nullptr) GTEST_SKIP() << "set YDD_MODELS to the folder with the network weights";
  for (const char* file : {"yolov5n_coco_anysize.onnx", "yolox_n_body_head_hand_anysize.onnx"}) {
    const auto onnx = read_file(std::filesystem::path(folder) / file);
    if (!onnx) GTEST_SKIP() << onnx.error().message;
    expect_sound(*onnx, 320, 256, 1e-3F);
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, OnednnPlanOn, testing::ValuesIn(kIsas),
                         [](const auto& tried) { return std::string(tried.param.name); });

}  // namespace
}  // namespace ydd
#endif
