// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ydd/image/decode.h"
#include "ydd/simulation/renderer.h"
#include "ydd/simulation/room.h"
#include "ydd/simulation/scene_builder.h"

namespace ydd {
namespace {

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr int kDefaultFrames = 300;
constexpr int kMinObjectPixels = 20;

sim::Scene make_scene(const WorldOptions& options) {
  const double detail = options.texture_detail * options.width_px / 640.0;
  sim::SceneBuilder builder(sim::Random(static_cast<std::uint64_t>(options.seed)), detail);
  sim::build_rooms(builder, options, {true, true});
  return std::move(builder).finish();
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

/// The picture with the noise of its sensor.
ColourImage expose(const sim::Rendering& rendering, const WorldOptions& options, int index) {
  const std::uint64_t seed = sim::mix_bits(static_cast<std::uint64_t>(options.seed),
                                           0x100000000ULL + static_cast<std::uint64_t>(index));
  sim::Random random(seed);
  const auto gain = static_cast<float>(1.0 + options.exposure_noise * random.normal());
  const auto noise = static_cast<float>(options.pixel_noise);
  const bool covered =
      index >= options.covered_from && index < options.covered_from + options.covered_frames;
  std::vector<Bgr> colours(rendering.colours.size());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      float value = covered ? 0.0F : gain * rendering.colours[i][static_cast<int>(k)];
      if (noise > 0) value += noise * sim::quick_normal(sim::mix_bits(seed + 3 * i + k));
      colours[i][k] = to_byte(value);
    }
  }
  return {options.width_px, options.height_px, std::move(colours)};
}

DepthImage exact_depth(const sim::Rendering& rendering, const Camera& camera) {
  std::vector<float> depth;
  depth.reserve(rendering.pixels.size());
  for (const sim::RenderedPixel& pixel : rendering.pixels) {
    const auto z = static_cast<double>(pixel.depth_m);
    depth.push_back(camera.is_valid_depth(z) ? pixel.depth_m : 0.0F);
  }
  return {camera.width_px, camera.height_px, std::move(depth)};
}

Image<std::uint8_t> make_mask(const sim::Rendering& rendering, const sim::Scene& scene,
                              const Camera& camera) {
  std::vector<std::uint8_t> ids;
  ids.reserve(rendering.pixels.size());
  for (const sim::RenderedPixel& pixel : rendering.pixels) {
    const bool moving = pixel.moving && pixel.object >= 0;
    ids.push_back(moving ? static_cast<std::uint8_t>(scene.objects[pixel.object].id) : 0);
  }
  return {camera.width_px, camera.height_px, std::move(ids)};
}

}  // namespace

struct Simulator::Impl {
  Impl(const WorldOptions& options_in, TimedPath path_in)
      : options(options_in),
        camera(simulated_camera(options_in)),
        path(std::move(path_in)),
        renderer(make_scene(options_in)) {}

  double time_s(int index) const { return 1e-9 * static_cast<double>(offset_ns(index)); }
  std::int64_t offset_ns(int index) const { return 1000 * std::llround(1e6 * index / options.fps); }

  WorldOptions options;
  Camera camera;
  TimedPath path;
  sim::Renderer renderer;
};

Simulator::Simulator(const WorldOptions& options)
    : impl_(std::make_unique<const Impl>(options, make_camera_path(options))) {}

Simulator::Simulator(const WorldOptions& options, CameraPath path)
    : impl_(std::make_unique<const Impl>(
          options, TimedPath{std::move(path), kDefaultFrames / options.fps})) {}

Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

int Simulator::frame_count() const {
  if (impl_->options.frames > 0) return impl_->options.frames;
  return static_cast<int>(std::ceil(impl_->path.round_s * impl_->options.fps));
}

const Camera& Simulator::camera() const { return impl_->camera; }

Timestamp Simulator::stamp(int index) const { return {kStart_ns + impl_->offset_ns(index)}; }

SE3 Simulator::T_world_camera(int index) const {
  return impl_->path.T_world_camera(impl_->time_s(index));
}

SimulatedFrame Simulator::render(int index) const {
  if (index < 0 || index >= frame_count()) {
    throw std::logic_error("Simulator: no such frame");
  }
  const WorldOptions& options = impl_->options;
  SimulatedFrame result;
  result.T_world_camera = T_world_camera(index);
  sim::RenderOptions render_options;
  render_options.edge_samples = options.edge_samples;
  render_options.threads = options.threads;
  const sim::Rendering rendering = impl_->renderer.render(impl_->camera, result.T_world_camera,
                                                          impl_->time_s(index), render_options);
  const ColourImage colour = expose(rendering, options, index);
  result.frame = {index, stamp(index), to_grey(colour), colour,
                  exact_depth(rendering, impl_->camera)};
  result.mask = make_mask(rendering, impl_->renderer.scene(), impl_->camera);
  return result;
}

}  // namespace ydd
