// SPDX-License-Identifier: Apache-2.0
// What a detector costs beside its network, and with it.
//
//   YDD_MODELS=<folder with weights> [YDD_ONNXRUNTIME=<libonnxruntime.so.1>] ydd_detection_bench
//
// Without YDD_MODELS only the parts around the network are measured.
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

#include "ydd/detection/boxes.h"
#include "ydd/detection/combined_detector.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/letterbox.h"
#include "ydd/detection/yolo_decode.h"
#include "ydd/inference/network.h"

namespace ydd {
namespace {

ColourImage noise_image(int width_px, int height_px) {
  std::mt19937 random(1);
  std::vector<Bgr> pixels(static_cast<std::size_t>(width_px) * height_px);
  for (Bgr& p : pixels) {
    const auto v = random();
    p = {static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v >> 8U),
         static_cast<std::uint8_t>(v >> 16U)};
  }
  return {width_px, height_px, std::move(pixels)};
}

void letterbox(benchmark::State& state) {
  cv::setNumThreads(1);
  const ColourImage image = noise_image(640, 480);
  InputFormat format;
  format.width_px = static_cast<int>(state.range(0));
  format.height_px = static_cast<int>(state.range(1));
  Letterboxer letterboxer(format);
  for (auto _ : state) benchmark::DoNotOptimize(letterboxer.prepare(image).values.data());
}
BENCHMARK(letterbox)
    ->Args({640, 480})
    ->Args({416, 320})
    ->Args({320, 256})
    ->Unit(benchmark::kMillisecond);

/// Outputs of a network in which about one cell in a hundred sees something.
struct Outputs {
  std::vector<std::vector<float>> values;
  std::vector<Tensor> tensors;

  void add(std::vector<int> shape) {
    std::size_t size = 1;
    for (const int d : shape) size *= static_cast<std::size_t>(d);
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    std::vector<float> v(size);
    for (float& x : v) x = uniform(random) < 0.01F ? 0.9F : 0.01F;
    values.push_back(std::move(v));
    tensors.push_back({std::move(shape), values.back()});
  }
};

Outputs outputs_of(YoloKind kind, const YoloShape& shape) {
  const int row = 5 + shape.class_count;
  int cells = 0;
  for (const int s : {8, 16, 32}) cells += (shape.width_px / s) * (shape.height_px / s);
  Outputs out;
  if (kind == YoloKind::yolov5) {
    out.add({1, 3 * cells, row});
  } else if (kind == YoloKind::yolov8) {
    out.add({1, row - 1, cells});
  } else {
    const int channels = kind == YoloKind::yolox_heads ? row : 3 * row;
    for (const int s : {8, 16, 32}) out.add({1, channels, shape.height_px / s, shape.width_px / s});
  }
  return out;
}

void decode(benchmark::State& state, YoloKind kind, int class_count) {
  const YoloShape shape{class_count, 640, 480};
  const Outputs outputs = outputs_of(kind, shape);
  std::size_t found = 0;
  for (auto _ : state) {
    const auto candidates = decode_yolo(kind, outputs.tensors, shape, 0.3F);
    found = candidates.size();
    benchmark::DoNotOptimize(candidates.data());
  }
  state.counters["candidates"] = static_cast<double>(found);
}
BENCHMARK_CAPTURE(decode, yolov5_coco, YoloKind::yolov5, 80)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode, yolov5_heads_coco, YoloKind::yolov5_heads, 80)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode, yolov8_coco, YoloKind::yolov8, 80)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode, yolox_body_head_hand, YoloKind::yolox_heads, 3)
    ->Unit(benchmark::kMillisecond);

void suppress_and_merge(benchmark::State& state) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  Detections detections;
  const char* classes[] = {"person", "body", "head", "hand", "chair"};
  for (int i = 0; i < 300; ++i) {
    const float x = 500 * uniform(random);
    const float y = 300 * uniform(random);
    const float size = 30 + 100 * uniform(random);
    detections.push_back({classes[i % 5], uniform(random), {x, y, x + size, y + 1.5F * size}});
  }
  const MergeOptions options;
  for (auto _ : state) {
    benchmark::DoNotOptimize(merge_people(suppress_non_maxima(detections, 0.45F), options).data());
  }
}
BENCHMARK(suppress_and_merge)->Unit(benchmark::kMillisecond);

bool has_models(benchmark::State& state) {
  if (std::getenv("YDD_MODELS") != nullptr) return true;
  state.SkipWithError("set YDD_MODELS to the folder with the network weights");
  return false;
}

/// One network on one back end; arguments: input width, height, threads.
void infer(benchmark::State& state, const char* model, const char* backend, const char* precision) {
  if (!has_models(state)) return;
  InferenceOptions options;
  options.backend = parse_choice<Backend>(backend).value();
  options.precision = parse_choice<Precision>(precision).value();
  options.threads = static_cast<int>(state.range(2));
  if (const char* library = std::getenv("YDD_ONNXRUNTIME")) options.onnxruntime = library;
  const auto session =
      load_network(std::filesystem::path(std::getenv("YDD_MODELS")) / model, options);
  if (!session) {
    state.SkipWithError(session.error().message.c_str());
    return;
  }
  const auto width = static_cast<int>(state.range(0));
  const auto height = static_cast<int>(state.range(1));
  const std::vector<float> grey(std::size_t{3} * width * height, 0.5F);
  for (auto _ : state) {
    const auto outputs = (*session)->run({{1, 3, height, width}, grey});
    if (!outputs) state.SkipWithError(outputs.error().message.c_str());
  }
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Args({320, 256, 1})->Args({416, 320, 1})->Args({512, 384, 1})->Args({640, 480, 1});
  bench->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
}

constexpr const char* kObjects = "yolov5n_coco_anysize.onnx";
constexpr const char* kPeople = "yolox_n_body_head_hand_anysize.onnx";
BENCHMARK_CAPTURE(infer, yolov5n / opencv, kObjects, "opencv", "float32")->Apply(sizes);
BENCHMARK_CAPTURE(infer, yolov5n / onnxruntime, kObjects, "onnxruntime", "float32")->Apply(sizes);
BENCHMARK_CAPTURE(infer, yolov5n / onednn, kObjects, "onednn", "float32")->Apply(sizes);
BENCHMARK_CAPTURE(infer, yolov5n / onednn_bf16, kObjects, "onednn", "bfloat16")->Apply(sizes);
BENCHMARK_CAPTURE(infer, yolox_n / opencv, kPeople, "opencv", "float32")->Apply(sizes);
BENCHMARK_CAPTURE(infer, yolox_n / onnxruntime, kPeople, "onnxruntime", "float32")->Apply(sizes);
BENCHMARK_CAPTURE(infer, yolox_n / onednn, kPeople, "onednn", "float32")->Apply(sizes);
BENCHMARK_CAPTURE(infer, yolox_n / onednn_bf16, kPeople, "onednn", "bfloat16")->Apply(sizes);

/// Both networks and everything around them, as configured. Arguments: input width, height.
void detect(benchmark::State& state) {
  if (!has_models(state)) return;
  const std::vector<std::string> set = {
      "networks.*.input.width=" + std::to_string(state.range(0)),
      "networks.*.input.height=" + std::to_string(state.range(1))};
  const auto file = std::filesystem::path(__FILE__).parent_path().parent_path() /
                    "configs/detector/coco_body_head_hand.yaml";
  const auto detector = make_detector(file, set);
  if (!detector) {
    state.SkipWithError(detector.error().message.c_str());
    return;
  }
  RgbdFrame frame;
  frame.colour = noise_image(640, 480);
  for (auto _ : state) {
    const auto found = (*detector)->detect(frame);
    if (!found) state.SkipWithError(found.error().message.c_str());
  }
}
BENCHMARK(detect)
    ->Args({320, 256})
    ->Args({416, 320})
    ->Args({512, 384})
    ->Args({640, 480})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ydd

BENCHMARK_MAIN();
