// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/depth_sensor.h"

#include <cmath>

#include "ydd/simulation/random.h"

namespace ydd::sim {
namespace {

constexpr double kBaseline_m = 0.075;
constexpr double kStep_px = 0.125;
constexpr int kSensorWidth_px = 640;
constexpr float kGrazing = 0.12F;   // cosine below which too little light comes back
constexpr float kEdgeStep = 0.03F;  // relative depth step that makes a silhouette
constexpr float kDropOut = 0.3F;    // share of silhouette pixels without a reading

/// Silhouettes wander in blocks of pixels, like the sensor's correlation window.
constexpr int kBlock_px = 2;

class KinectSensor {
 public:
  KinectSensor(const Rendering& rendering, const Camera& camera, std::uint64_t seed)
      : pixels_(rendering.pixels),
        camera_(camera),
        seed_(seed),
        bf_(camera.fx_px * kSensorWidth_px / camera.width_px * kBaseline_m) {}

  float read(int x, int y) const {
    const std::uint64_t hash = mix_bits(seed_ + index(x, y));
    const std::size_t source = wander(x, y, hash);
    const RenderedPixel& pixel = pixels_[source];
    if (pixel.depth_m <= 0 || !pixel.lit_by_projector || pixel.facing < kGrazing) return 0;
    if (source != index(x, y) && unit_float(mix_bits(hash)) < kDropOut) return 0;
    const double exact = static_cast<double>(pixel.depth_m);
    const double noisy =
        exact + kinect_noise_m(exact) * static_cast<double>(quick_normal(mix_bits(hash + 1)));
    if (noisy <= 0) return 0;
    const double disparity = std::round(bf_ / noisy / kStep_px) * kStep_px;
    if (disparity <= 0) return 0;
    const double depth = bf_ / disparity;
    return camera_.is_valid_depth(depth) ? static_cast<float>(depth) : 0.0F;
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * camera_.width_px + static_cast<std::size_t>(x);
  }
  /// The pixel that this one reads: itself, or near a silhouette perhaps one beyond it.
  std::size_t wander(int x, int y, std::uint64_t hash) const {
    const std::uint64_t block =
        mix_bits(seed_ ^ mix_bits(static_cast<std::uint64_t>(x / kBlock_px),
                                  static_cast<std::uint64_t>(y / kBlock_px)));
    const int dx = static_cast<int>(block % 3) - 1;
    const int dy = static_cast<int>((block >> 8U) % 3) - 1;
    const int reach = (hash & 3U) == 0 ? 2 : 1;
    const int nx = x + reach * dx;
    const int ny = y + reach * dy;
    if (nx < 0 || ny < 0 || nx >= camera_.width_px || ny >= camera_.height_px) return index(x, y);
    const float here = pixels_[index(x, y)].depth_m;
    const float there = pixels_[index(nx, ny)].depth_m;
    return std::abs(there - here) > kEdgeStep * here ? index(nx, ny) : index(x, y);
  }

  const std::vector<RenderedPixel>& pixels_;
  const Camera& camera_;
  std::uint64_t seed_;
  double bf_;
};

}  // namespace

DepthImage exact_depth(const Rendering& rendering, const Camera& camera) {
  std::vector<float> depth;
  depth.reserve(rendering.pixels.size());
  for (const RenderedPixel& pixel : rendering.pixels) {
    const bool valid = camera.is_valid_depth(static_cast<double>(pixel.depth_m));
    depth.push_back(valid ? pixel.depth_m : 0.0F);
  }
  return {camera.width_px, camera.height_px, std::move(depth)};
}

double kinect_noise_m(double depth_m) {
  const double beyond = depth_m - 0.4;
  return 0.0012 + 0.0019 * beyond * beyond;
}

DepthImage kinect_depth(const Rendering& rendering, const Camera& camera, std::uint64_t seed) {
  const KinectSensor sensor(rendering, camera, seed);
  std::vector<float> depth;
  depth.reserve(rendering.pixels.size());
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) depth.push_back(sensor.read(x, y));
  }
  return {camera.width_px, camera.height_px, std::move(depth)};
}

Vector3 kinect_projector_camera_m() { return {static_cast<float>(kBaseline_m), 0, 0}; }

}  // namespace ydd::sim
