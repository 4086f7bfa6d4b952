// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ydd/image/decode.h"
#include "ydd/simulation/annotation.h"
#include "ydd/simulation/depth_sensor.h"
#include "ydd/simulation/illumination.h"
#include "ydd/simulation/movers.h"
#include "ydd/simulation/people.h"
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
  const sim::Cast cast = sim::choose_cast(options);
  sim::build_rooms(builder, options, {!cast.pushed_chair, true});
  builder.reseed(sim::Random(sim::mix_bits(static_cast<std::uint64_t>(options.seed), 99)));
  sim::add_actors(builder, options, cast);
  sim::add_large_mover(builder, options);
  if (options.frozen_at_s >= 0) builder.freeze(options.frozen_at_s);
  builder.set_light(sim::make_light_changes(options));
  return std::move(builder).finish();
}

/// A number of its own for everything random in a frame.
std::uint64_t frame_seed(const WorldOptions& options, int index) {
  constexpr std::uint64_t kFrames = 1ULL << 32U;
  return sim::mix_bits(static_cast<std::uint64_t>(options.seed),
                       kFrames + static_cast<std::uint64_t>(index));
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

/// Somebody holds a hand before the lens: a black picture, no depth.
bool is_covered(const WorldOptions& options, int index) {
  return index >= options.covered_from && index < options.covered_from + options.covered_frames;
}

DepthImage no_depth(const Camera& camera) {
  return {camera.width_px, camera.height_px,
          std::vector<float>(static_cast<std::size_t>(camera.width_px) * camera.height_px)};
}

/// The picture with the noise of its sensor. `automatic` is what the camera chose by itself, BGR.
ColourImage expose(const sim::Rendering& rendering, const WorldOptions& options,
                   const Eigen::Array3f& automatic, int index) {
  const std::uint64_t seed = frame_seed(options, index);
  sim::Random random(seed);
  const Eigen::Array3f gain =
      automatic * static_cast<float>(1.0 + options.exposure_noise * random.normal());
  const float noise = static_cast<float>(options.pixel_noise) * std::sqrt(automatic.mean());
  const bool covered =
      index >= options.covered_from && index < options.covered_from + options.covered_frames;
  std::vector<Bgr> colours(rendering.colours.size());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      float value =
          covered ? 0.0F : gain[static_cast<int>(k)] * rendering.colours[i][static_cast<int>(k)];
      if (noise > 0) value += noise * sim::quick_normal(sim::mix_bits(seed + 3 * i + k));
      colours[i][k] = to_byte(value);
    }
  }
  return {options.width_px, options.height_px, std::move(colours)};
}

}  // namespace

struct Simulator::Impl {
  Impl(const WorldOptions& options_in, TimedPath path_in)
      : options(options_in),
        camera(simulated_camera(options_in)),
        path(std::move(path_in)),
        renderer(make_scene(options_in)),
        probe(renderer.scene()) {}

  double time_s(int index) const { return 1e-9 * static_cast<double>(offset_ns(index)); }
  std::int64_t offset_ns(int index) const { return 1000 * std::llround(1e6 * index / options.fps); }
  /// The depth sensor looks at the same time and along the same rays as the colour camera.
  bool is_depth_aligned() const {
    return options.registration_off_px <= 0 && options.depth_late_ms <= 0;
  }
  sim::Rendering render(const Camera& from, double time, int edge_samples, bool projector) const {
    return renderer.render(
        from, path.T_world_camera(time), time,
        {edge_samples, options.threads, projector, sim::kinect_projector_camera_m()});
  }
  /// What the depth sensor looks at instead of what the colour camera sees at `time`.
  sim::Rendering render_misaligned_depth(double time) const {
    Camera shifted = camera;
    shifted.cx_px += options.registration_off_px * options.width_px / 640.0;
    return render(shifted, time - 1e-3 * options.depth_late_ms, 1,
                  options.depth == DepthModel::kinect);
  }
  DepthImage sense_depth(const sim::Rendering& rendering, int index) const {
    if (is_covered(options, index)) return no_depth(camera);
    if (options.depth == DepthModel::exact) return sim::exact_depth(rendering, camera);
    return sim::kinect_depth(rendering, camera, sim::mix_bits(frame_seed(options, index), 1));
  }

  WorldOptions options;
  Camera camera;
  TimedPath path;
  sim::Renderer renderer;
  sim::MotionProbe probe;
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

SE3 Simulator::pose(int index) const { return impl_->path.T_world_camera(impl_->time_s(index)); }

std::vector<SimulatedMover> Simulator::movers(int index) const {
  const sim::Scene& scene = impl_->renderer.scene();
  const double time_s = impl_->time_s(index);
  const double half_s = 0.5 / impl_->options.fps;
  const auto now = impl_->probe.middles(scene, time_s);
  const auto before = impl_->probe.middles(scene, time_s - half_s);
  const auto after = impl_->probe.middles(scene, time_s + half_s);
  std::vector<SimulatedMover> out;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const sim::SceneObject& object = scene.objects[i];
    if (!object.moving || object.whole >= 0 || !now[i]) continue;
    out.push_back({object.class_name, object.name, object.id, *now[i],
                   (*after[i] - *before[i]) / (2 * half_s)});
  }
  return out;
}

MotionSamples Simulator::motion_samples() const {
  constexpr double kBefore_s = 0.5, kAfter_s = 0.05;
  return sense_motion(impl_->path.T_world_camera, stamp(0), -kBefore_s,
                      impl_->time_s(frame_count() - 1) + kAfter_s, impl_->options.sensors,
                      impl_->options.seed);
}

SimulatedFrame Simulator::render(int index) const {
  if (index < 0 || index >= frame_count()) {
    throw std::logic_error("Simulator: no such frame");
  }
  const WorldOptions& options = impl_->options;
  const Camera& camera = impl_->camera;
  const sim::Scene& scene = impl_->renderer.scene();
  const double time_s = impl_->time_s(index);
  const bool aligned = impl_->is_depth_aligned();
  const sim::Rendering rendering = impl_->render(camera, time_s, options.edge_samples,
                                                 aligned && options.depth == DepthModel::kinect);
  const Eigen::Array3f automatic =
      scene.light ? sim::automatic_gain(rendering.colours, scene.light->at(time_s).exposure)
                  : Eigen::Array3f::Ones();
  const ColourImage colour = expose(rendering, options, automatic, index);
  DepthImage depth_m =
      impl_->sense_depth(aligned ? rendering : impl_->render_misaligned_depth(time_s), index);
  const std::vector<bool> moving = impl_->probe.moving_objects(scene, time_s, 1.0 / options.fps);
  SimulatedFrame result;
  result.frame = {index, stamp(index), to_grey(colour), colour, std::move(depth_m)};
  result.T_world_camera = impl_->path.T_world_camera(time_s);
  if (!is_covered(options, index)) {
    result.objects = sim::visible_objects(rendering, scene, camera.width_px, moving,
                                          kMinObjectPixels * camera.width_px / 640);
  }
  result.mask = sim::mover_mask(rendering, scene, camera);
  return result;
}

}  // namespace ydd
