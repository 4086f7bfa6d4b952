// SPDX-License-Identifier: Apache-2.0
// What the dynamic decision costs, as a whole and by stage, next to the ORB extraction of the same
// frame, on one thread.
//
//     YDD_DATA=<folder with crowd_xyz> ydd_dynamics_bench
//
// Source 0 is a painted scene (three persons with heads and hands, cups, chairs, monitors, sensor
// noise and shadows), source 1 the frame of crowd_xyz with the most detections (with YDD_DATA).
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "ydd/detection/recorded_detections.h"
#include "ydd/dynamics/connected_things.h"
#include "ydd/dynamics/judge.h"
#include "ydd/dynamics/moving_regions.h"
#include "ydd/features/orb_extractor.h"
#include "ydd/image/decode.h"

namespace ydd {
namespace {

struct Input {
  GreyImage grey;
  DepthImage depth_m;
  Detections detections;
};

class Painter {
 public:
  Painter() : grey_(kWidth * kHeight, 90), depth_(kWidth * kHeight, 4.0F) {}

  void thing(const std::string& name, const Box& box, float depth_m) {
    for (int y = std::max(0, int(box.y0)); y < std::min(kHeight, int(box.y1)); ++y) {
      // The projector's shadow falls to the right of what stands in front.
      const int shadow = int(box.x1) + int(12.0F / depth_m);
      for (int x = std::max(0, int(box.x0)); x < std::min(kWidth, shadow); ++x) {
        depth_[std::size_t(y * kWidth + x)] = float(x) < box.x1 ? depth_m : 0.0F;
        if (float(x) < box.x1) grey_[std::size_t(y * kWidth + x)] = std::uint8_t(random_() % 200);
      }
    }
    detections_.push_back({name, 0.9F, box});
  }

  Input finish() {
    std::normal_distribution<float> noise(0.0F, 0.004F);
    for (float& d : depth_) {
      d = d > 0.0F && random_() % 50 != 0 ? d + noise(random_) * d * d : 0.0F;
    }
    for (std::uint8_t& p : grey_) p = std::uint8_t(p + random_() % 40);
    return {{kWidth, kHeight, grey_}, {kWidth, kHeight, depth_}, detections_};
  }

 private:
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;
  std::mt19937 random_{1};
  std::vector<std::uint8_t> grey_;
  std::vector<float> depth_;
  Detections detections_;
};

Input painted_input() {
  Painter painter;
  for (int i = 0; i < 3; ++i) {
    const auto x = float(20 + 200 * i);
    painter.thing("monitor", {x + 100, 180, x + 210, 270}, 2.6F);
    painter.thing("chair", {x + 120, 260, x + 230, 470}, 2.0F);
    painter.thing("person", {x, 60, x + 150, 470}, 1.3F + 0.3F * float(i));
    painter.thing("head", {x + 45, 60, x + 100, 130}, 1.32F + 0.3F * float(i));
    painter.thing("hand", {x - 10, 240, x + 25, 285}, 1.2F + 0.3F * float(i));
    painter.thing("hand", {x + 130, 240, x + 165, 285}, 1.25F + 0.3F * float(i));
    painter.thing("cup", {x + 150, 245, x + 180, 285}, 1.25F + 0.3F * float(i));
    painter.thing("book", {x + 60, 300, x + 110, 340}, 2.5F);
  }
  return painter.finish();
}

std::optional<Input> recorded_input() {
  const char* data = std::getenv("YDD_DATA");
  if (data == nullptr) return std::nullopt;
  const auto folder = std::filesystem::path(data) / "crowd_xyz";
  const auto recording = DetectionRecording::read(folder / "detections_gt.jsonl");
  if (!recording) return std::nullopt;
  const RecordedFrame* fullest = nullptr;
  for (const RecordedFrame& frame : recording->frames()) {
    if (fullest == nullptr || frame.detections.size() > fullest->detections.size()) {
      fullest = &frame;
    }
  }
  if (fullest == nullptr) return std::nullopt;
  const std::string stem = std::filesystem::path(fullest->file).stem().string();
  const auto colour = load_colour(folder / "rgb" / (stem + ".jpg"));
  const auto depth_m = load_depth(folder / "depth" / (stem + ".png"), Camera());
  if (!colour || !depth_m) return std::nullopt;
  Input input{to_grey(*colour), *depth_m, {}};
  for (const RecordedDetection& d : fullest->detections) input.detections.push_back(d.detection);
  return input;
}

std::optional<Input> input_of(benchmark::State& state) {
  const auto input = state.range(0) == 0 ? std::optional(painted_input()) : recorded_input();
  if (!input) state.SkipWithError("set YDD_DATA to the folder that holds crowd_xyz");
  return input;
}

Features features_of(const Input& input, int points) {
  return with_geometry(OrbExtractor(OrbOptions()).extract(input.grey, points), Camera(),
                       input.depth_m);
}

void judge(benchmark::State& state, const DynamicsOptions& options) {
  const auto input = input_of(state);
  if (!input) return;
  const Features features = features_of(*input, int(state.range(1)));
  const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  DynamicsJudge dynamics(options, catalogue);
  int rejected = 0;
  for (auto _ : state) {
    const Judgement judgement = dynamics.judge(features, input->detections, input->depth_m);
    rejected = judgement.rejected();
    benchmark::DoNotOptimize(rejected);
  }
  state.counters["points"] = double(features.size());
  state.counters["rejected"] = rejected;
  state.counters["detections"] = double(input->detections.size());
}

void Judge(benchmark::State& state, ydd::Variant variant) {
  DynamicsOptions options;
  options.variant = variant;
  judge(state, options);
}

void JudgeByTheArticle(benchmark::State& state) {
  DynamicsOptions options;
  options.refinement.enabled = false;
  judge(state, options);
}

void SplitFeatures(benchmark::State& state) {
  const auto input = input_of(state);
  if (!input) return;
  const Features features = features_of(*input, int(state.range(1)));
  const Judgement judgement = judge_frame(DynamicsOptions(), ObjectCatalogue::defaults(), features,
                                          input->detections, input->depth_m);
  for (auto _ : state) benchmark::DoNotOptimize(filter_features(features, judgement));
}

void MeasureAndMatch(benchmark::State& state) {
  const auto input = input_of(state);
  if (!input) return;
  const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        make_scene(input->detections, catalogue, input->depth_m, DynamicsOptions()));
  }
}

void Regions(benchmark::State& state) {
  const auto input = input_of(state);
  if (!input) return;
  const DynamicsOptions options;
  const Scene scene =
      make_scene(input->detections, ObjectCatalogue::defaults(), input->depth_m, options);
  for (auto _ : state) {
    benchmark::DoNotOptimize(body_regions(scene, options));
    benchmark::DoNotOptimize(thing_regions(scene, options));
  }
}

void ConnectedThings(benchmark::State& state) {
  const auto input = input_of(state);
  if (!input) return;
  const DynamicsOptions options;
  const Scene scene =
      make_scene(input->detections, ObjectCatalogue::defaults(), input->depth_m, options);
  const std::vector<MovingRegion> bodies = body_regions(scene, options);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        connected_things(input->depth_m, bodies, options.refinement.connected_things));
  }
}

void OrbExtraction(benchmark::State& state) {
  const auto input = input_of(state);
  if (!input) return;
  OrbExtractor extractor{OrbOptions()};
  for (auto _ : state) {
    benchmark::DoNotOptimize(extractor.extract(input->grey, int(state.range(1))));
  }
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"source", "points"})->Unit(benchmark::kMicrosecond);
  for (const int source : {0, 1}) {
    for (const int points : {1000, 3500}) bench->Args({source, points});
  }
}
void sources(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"source"})->Unit(benchmark::kMicrosecond)->Arg(0)->Arg(1);
}

BENCHMARK_CAPTURE(Judge, full, ydd::Variant::full)->Apply(sizes);
BENCHMARK_CAPTURE(Judge, person, ydd::Variant::person)->Apply(sizes);
BENCHMARK_CAPTURE(Judge, box, ydd::Variant::box)->Apply(sizes);
BENCHMARK(JudgeByTheArticle)->Apply(sizes);
BENCHMARK(SplitFeatures)->Apply(sizes);
BENCHMARK(OrbExtraction)->Apply(sizes);
BENCHMARK(MeasureAndMatch)->Apply(sources);
BENCHMARK(Regions)->Apply(sources);
BENCHMARK(ConnectedThings)->Apply(sources);

}  // namespace
}  // namespace ydd

BENCHMARK_MAIN();
