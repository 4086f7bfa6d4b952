// SPDX-License-Identifier: Apache-2.0
// What feature extraction and matching cost, stage by stage, on one thread.
//
//     YDD_DATA=<folder with tum_fr1_xyz> ydd_features_bench
//
// Argument 0 is a rendered texture of 640x480, argument 1 a frame of tum_fr1_xyz (with YDD_DATA).
// OnePassOverPyramid reads every pixel of every level once and writes one byte for it: no extractor
// can be faster than reading its input. OpenCvOrb is cv::ORB, for reference.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "ydd/features/matching.h"
#include "ydd/features/orb_blur.h"
#include "ydd/features/orb_brief.h"
#include "ydd/features/orb_corners.h"
#include "ydd/features/orb_distribution.h"
#include "ydd/features/orb_extractor.h"
#include "ydd/features/orb_orientation.h"
#include "ydd/features/orb_pyramid.h"
#include "ydd/features/simd.h"
#include "ydd/image/decode.h"

namespace ydd {
namespace {

constexpr int kBorder_px = 18;

/// Overlapping boxes and discs with a little noise, magnified by `zoom` about the corner.
GreyImage textured_image(unsigned seed, double shift_px = 0.0) {
  std::mt19937 random(seed);
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < 4000; ++i) {
    const double r = std::min(2.5 / std::sqrt((double(random() % 10000) + 1) / 10000), 80.0);
    const double y = double(random() % 540) - 30;
    const cv::Point2d c(double(random() % 700) - 30 + shift_px, y);
    const cv::Scalar grey(double(random() % 256));
    if (random() % 2 == 0) {
      cv::circle(image, cv::Point(c * 16), int(r * 16), grey, cv::FILLED, cv::LINE_AA, 4);
    } else {
      cv::rectangle(image, cv::Rect2d(c.x - r, c.y - r, 2 * r, 2 * r), grey, cv::FILLED);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.7);
  std::normal_distribution<double> noise(0.0, 2.0);
  std::vector<std::uint8_t> pixels(image.begin<std::uint8_t>(), image.end<std::uint8_t>());
  for (auto& p : pixels) {
    p = static_cast<std::uint8_t>(std::clamp(std::lround(p + noise(random)), 0L, 255L));
  }
  return {image.cols, image.rows, std::move(pixels)};
}

std::optional<GreyImage> real_image() {
  const char* data = std::getenv("YDD_DATA");
  if (data == nullptr) return std::nullopt;
  std::vector<std::filesystem::path> files;
  std::error_code no_such_folder;
  const auto folder = std::filesystem::path(data) / "tum_fr1_xyz" / "rgb";
  for (const auto& f : std::filesystem::directory_iterator(folder, no_such_folder)) {
    files.push_back(f.path());
  }
  if (files.empty()) return std::nullopt;
  std::sort(files.begin(), files.end());
  const auto colour = load_colour(files[files.size() / 2]);
  if (!colour) return std::nullopt;
  return to_grey(*colour);
}

/// The picture that a benchmark's first argument names; marks the run as skipped without it.
std::optional<GreyImage> image_of(benchmark::State& state) {
  auto image = state.range(0) == 0 ? std::optional(textured_image(1)) : real_image();
  if (!image) state.SkipWithError("set YDD_DATA to the folder that holds tum_fr1_xyz");
  return image;
}

void OnePassOverPyramid(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  OrbPyramid pyramid(8, 1.2, 40);
  const auto levels = pyramid.build(*image);
  std::vector<std::uint8_t> out(static_cast<std::size_t>(image->width() + 64));
  for (auto _ : state) {
    for (const GreyView& level : levels) {
      for (int y = 0; y < level.height; ++y) {
        const std::uint8_t* row = level.row(y);
        // The last vector ends with the row, so that nothing behind the image is read.
        for (int x = 0; x < level.width; x += simd::kLanes8) {
          const int at = std::min(x, level.width - simd::kLanes8);
          simd::store(&out[at], simd::average(simd::load(&out[at]), simd::load(row + at)));
        }
      }
    }
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
}

void Pyramid(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  OrbPyramid pyramid(8, 1.2, 40);
  for (auto _ : state) benchmark::DoNotOptimize(pyramid.build(*image));
}

void Corners(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  OrbPyramid pyramid(8, 1.2, 40);
  const auto levels = pyramid.build(*image);
  std::vector<CornerDetector> detectors(levels.size());
  std::size_t count = 0;
  for (auto _ : state) {
    count = 0;
    for (std::size_t l = 0; l < levels.size(); ++l) {
      count += detectors[l].detect(levels[l], kBorder_px, 20, 7).size();
    }
  }
  state.counters["corners"] = static_cast<double>(count);
}

void Distribution(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  OrbPyramid pyramid(8, 1.2, 40);
  const auto levels = pyramid.build(*image);
  std::vector<CornerDetector> detectors(levels.size());
  std::vector<std::span<const Corner>> corners;
  std::vector<int> available;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    corners.push_back(detectors[l].detect(levels[l], kBorder_px, 20, 7));
    available.push_back(static_cast<int>(corners.back().size()));
  }
  CornerSelector selector;
  for (auto _ : state) {
    const std::vector<int> quotas = level_quotas(static_cast<int>(state.range(1)), 1.2, available);
    for (std::size_t l = 0; l < levels.size(); ++l) {
      benchmark::DoNotOptimize(
          selector.select(corners[l], levels[l].width, levels[l].height, quotas[l]));
    }
  }
}

void Blur(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  OrbPyramid pyramid(8, 1.2, 40);
  const auto levels = pyramid.build(*image);
  std::vector<OrbBlur> blurs(levels.size());
  for (auto _ : state) {
    for (std::size_t l = 0; l < levels.size(); ++l) {
      benchmark::DoNotOptimize(blurs[l].apply(levels[l]));
    }
  }
}

/// Corners of a picture all over its first level.
std::vector<Corner> some_corners(const GreyView& view, std::size_t count) {
  CornerDetector detector;
  const auto all = detector.detect(view, kBorder_px, 20, 7);
  CornerSelector selector;
  const auto chosen = selector.select(all, view.width, view.height, static_cast<int>(count));
  return {chosen.begin(), chosen.end()};
}

void Orientation1000(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  const GreyView view{image->data(), image->width(), image->height(), image->width()};
  const std::vector<Corner> corners = some_corners(view, 1000);
  for (auto _ : state) {
    float sum = 0.0F;
    for (const Corner& c : corners) sum += intensity_centroid_angle_rad(view, c.x, c.y);
    benchmark::DoNotOptimize(sum);
  }
}

void Descriptors1000(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  const GreyView view{image->data(), image->width(), image->height(), image->width()};
  const std::vector<Corner> corners = some_corners(view, 1000);
  std::vector<float> angles_rad;
  angles_rad.reserve(corners.size());
  for (const Corner& c : corners) {
    angles_rad.push_back(intensity_centroid_angle_rad(view, c.x, c.y));
  }
  OrbBlur blur;
  const GreyView smooth = blur.apply(view);
  const SteeredBrief brief;
  for (auto _ : state) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      benchmark::DoNotOptimize(brief.describe(smooth, corners[i].x, corners[i].y, angles_rad[i]));
    }
  }
}

void Extract(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  OrbExtractor extractor(OrbOptions{.threads = static_cast<int>(state.range(2))});
  std::size_t count = 0;
  for (auto _ : state) {
    count = extractor.extract(*image, static_cast<int>(state.range(1))).keypoints.size();
  }
  state.counters["points"] = static_cast<double>(count);
}

void OpenCvOrb(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  cv::Mat grey(image->height(), image->width(), CV_8UC1);
  std::copy(image->data(), image->data() + grey.total(), grey.data);
  const auto orb = cv::ORB::create(static_cast<int>(state.range(1)), 1.2F, 8, 19);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  for (auto _ : state) orb->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  cv::setNumThreads(threads);
  state.counters["points"] = static_cast<double>(keypoints.size());
}

/// What following the last frame's points costs instead of extracting new ones: pyramidal
/// Lucas-Kanade (OpenCV, one thread), pyramids included, and back again, the usual check.
void LucasKanade(benchmark::State& state) {
  const auto image = image_of(state);
  if (!image) return;
  const GreyImage other = state.range(0) == 0 ? textured_image(1, 4.0) : *image;
  const auto as_mat = [](const GreyImage& grey) {
    cv::Mat mat(grey.height(), grey.width(), CV_8UC1);
    std::copy(grey.data(), grey.data() + mat.total(), mat.data);
    return mat;
  };
  const cv::Mat first = as_mat(*image), second = as_mat(other);
  std::vector<cv::Point2f> points, moved, back;
  for (const Keypoint& k :
       OrbExtractor(OrbOptions{}).extract(*image, static_cast<int>(state.range(1))).keypoints) {
    points.emplace_back(k.x_px, k.y_px);
  }
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  std::vector<std::uint8_t> found;
  std::vector<float> error;
  const cv::Size window(15, 15);
  constexpr int kLevels = 3;
  for (auto _ : state) {
    std::vector<cv::Mat> pyramid_a, pyramid_b;
    cv::buildOpticalFlowPyramid(first, pyramid_a, window, kLevels);
    cv::buildOpticalFlowPyramid(second, pyramid_b, window, kLevels);
    cv::calcOpticalFlowPyrLK(pyramid_a, pyramid_b, points, moved, found, error, window, kLevels);
    cv::calcOpticalFlowPyrLK(pyramid_b, pyramid_a, moved, back, found, error, window, kLevels);
  }
  cv::setNumThreads(threads);
  state.counters["points"] = static_cast<double>(points.size());
}

Features features_of(const GreyImage& image, int count) {
  OrbExtractor extractor(OrbOptions{});
  return with_geometry(extractor.extract(image, count), Camera{}, DepthImage());
}

void BuildGrid(benchmark::State& state) {
  const Features features = features_of(textured_image(1), 1000);
  for (auto _ : state) benchmark::DoNotOptimize(KeypointGrid(features, Camera{}));
}

void MatchInWindow(benchmark::State& state) {
  const Features reference = features_of(textured_image(1), 1000);
  const Features seen = features_of(textured_image(1, 4.0), 1000);
  const KeypointGrid grid(seen, Camera{});
  const auto radius_px = static_cast<float>(state.range(0));
  std::vector<int> candidates;
  int good = 0;
  for (auto _ : state) {
    good = 0;
    for (std::size_t i = 0; i < reference.size(); ++i) {
      const Eigen::Vector2f& px = reference.undistorted_px[i];
      const int octave = reference.keypoints[i].octave;
      grid.query(px.x(), px.y(), radius_px, octave - 1, octave + 1, candidates);
      const BestMatch match = best_match(reference.descriptors[i], seen, candidates);
      good += match.distance <= 50 ? 1 : 0;
    }
  }
  state.counters["matches"] = good;
}

void MatchAll(benchmark::State& state) {
  const Features reference = features_of(textured_image(1), 1000);
  const Features seen = features_of(textured_image(1, 4.0), 1000);
  std::vector<int> all(seen.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  for (auto _ : state) {
    for (const Descriptor& d : reference.descriptors) {
      benchmark::DoNotOptimize(best_match(d, seen, all));
    }
  }
}

void MedianOf(benchmark::State& state) {
  const OrbFeatures f = OrbExtractor(OrbOptions{}).extract(textured_image(1), 1000);
  const std::span all(f.descriptors);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        median_descriptor(all.first(static_cast<std::size_t>(state.range(0)))));
  }
}

constexpr auto kUnit = benchmark::kMicrosecond;
BENCHMARK(OnePassOverPyramid)->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(Pyramid)->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(Corners)->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(Distribution)->ArgsProduct({{0, 1}, {1000, 3500}})->Unit(kUnit);
BENCHMARK(Blur)->Arg(0)->Arg(1)->Unit(kUnit);
BENCHMARK(Orientation1000)->Arg(0)->Unit(kUnit);
BENCHMARK(Descriptors1000)->Arg(0)->Unit(kUnit);
BENCHMARK(Extract)->ArgsProduct({{0, 1}, {1000, 2000, 3500}, {1}})->Unit(kUnit);
BENCHMARK(Extract)->Args({0, 1000, 2})->Args({1, 1000, 2})->Unit(kUnit)->UseRealTime();
BENCHMARK(OpenCvOrb)->ArgsProduct({{0, 1}, {1000}})->Unit(kUnit);
BENCHMARK(LucasKanade)->ArgsProduct({{0, 1}, {500, 1000}})->Unit(kUnit);
BENCHMARK(BuildGrid)->Unit(kUnit);
BENCHMARK(MatchInWindow)->Arg(7)->Arg(15)->Arg(40)->Unit(kUnit);
BENCHMARK(MatchAll)->Unit(kUnit);
BENCHMARK(MedianOf)->Arg(5)->Arg(20)->Unit(kUnit);

}  // namespace
}  // namespace ydd

BENCHMARK_MAIN();
