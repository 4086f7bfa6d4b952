// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/renderer.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "ydd/simulation/lighting.h"
#include "ydd/simulation/ray_scene.h"
#include "ydd/simulation/shading.h"

namespace ydd::sim {
namespace {

constexpr int kPacket = 8;  // rays that Embree traces together: 4 x 2 pixels
constexpr int kPacketWidth = 4;
constexpr int kPacketHeight = 2;
constexpr float kNear_m = 0.02F;

struct PacketPixels {
  std::array<float, kPacket> x{};
  std::array<float, kPacket> y{};
  int count = 0;

  void add(float px, float py) {
    x[count] = px;
    y[count] = py;
    ++count;
  }
};

/// Runs `job(i)` for i in [0, count), on several threads if asked. Each i writes its own results.
template <class Job>
void for_each_index(int count, int threads, const Job& job) {
  if (threads == 1) {
    for (int i = 0; i < count; ++i) job(i);
    return;
  }
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : threads);
  arena.execute([&] { tbb::parallel_for(0, count, job); });
}

View make_view(const Camera& camera, const SE3& T_world_camera, const SE3& T_world_body) {
  const SE3 T_body_camera = T_world_body.inverse() * T_world_camera;
  const Eigen::Matrix3d rotation = T_body_camera.rotation_matrix();
  const Eigen::Vector3d corner(-camera.cx_px / camera.fx_px, -camera.cy_px / camera.fy_px, 1.0);
  View view;
  view.origin = T_body_camera.translation().cast<float>();
  view.corner = (rotation * corner).cast<float>();
  view.step_x = (rotation.col(0) / camera.fx_px).cast<float>();
  view.step_y = (rotation.col(1) / camera.fy_px).cast<float>();
  view.rotation_world = T_world_body.rotation_matrix().cast<float>();
  view.translation_world = T_world_body.translation().cast<float>();
  return view;
}

/// The i-th of `count` well-spread positions in a pixel, relative to its centre (Hammersley).
Vector2 sub_pixel(int i, int count) {
  float inverse = 0;
  float weight = 0.5F;
  for (int bits = i; bits > 0; bits >>= 1, weight *= 0.5F) {
    if ((bits & 1) != 0) inverse += weight;
  }
  const float n = 1.0F / static_cast<float>(count);
  return {(static_cast<float>(i) + 0.5F) * n - 0.5F, inverse + 0.5F * n - 0.5F};
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(Scene scene_in);

  Scene scene;
  Device device;
  std::vector<RayScene> groups;                ///< the fixed world, then all bodies in order
  std::vector<std::vector<Surface>> surfaces;  ///< [group][geometry]
};

Renderer::Impl::Impl(Scene scene_in) : scene(std::move(scene_in)), device(make_device()) {
  const auto add_group = [&](const std::vector<Part>& parts,
                             const std::vector<std::vector<float>>& lights,
                             const std::vector<std::vector<SourceShares>>& shares) {
    std::vector<Surface>& group = surfaces.emplace_back();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      group.push_back(make_surface(parts[i], scene.textures,
                                   lights.empty() ? std::vector<float>() : lights[i],
                                   shares.empty() ? std::vector<SourceShares>() : shares[i]));
    }
  };
  groups.push_back(make_ray_scene(device, scene.fixed));
  const bool changes = scene.light.has_value();
  add_group(
      scene.fixed, bake_light(scene, groups.front()),
      changes ? bake_shares(scene, groups.front()) : std::vector<std::vector<SourceShares>>());
  for (const Actor& actor : scene.actors) {
    for (const Body& body : actor.bodies) {
      groups.push_back(make_ray_scene(device, body.parts));
      add_group(body.parts, {}, {});
    }
  }
}

/// One picture in the making.
class Renderer::Exposure {
 public:
  Exposure(const Impl& world, const Camera& camera, const SE3& T_world_camera, double time_s,
           const RenderOptions& options);
  Rendering take();

 private:
  using Hits = std::array<SurfaceHit, kPacket>;
  Hits trace(const PacketPixels& pixels, bool coherent) const;
  void trace_rows(int strip);
  void test_projector(const PacketPixels& pixels, const Hits& hits, bool* lit) const;
  void shade_row(int y);
  void smooth_edges_of_row(int y);
  void smooth_edge_pixels(const std::vector<int>& columns, int y);
  bool is_edge(int x, int y) const;
  bool differ(const SurfaceHit& a, const SurfaceHit& b) const;
  RenderedPixel describe(const SurfaceHit& hit, int x, int y) const;
  Eigen::Array3f colour(const SurfaceHit& hit, float x, float y, float footprint_px) const;
  int index(int x, int y) const { return y * camera_.width_px + x; }

  const Impl& world_;
  const Camera& camera_;
  const RenderOptions& options_;
  std::vector<View> views_;  ///< per group; the first is the world frame
  RayScene rays_;
  Vector3 projector_world_m_;
  std::optional<LightNow> light_;  ///< nothing: steady
  std::vector<SurfaceHit> hits_;   ///< at pixel centres
  Rendering result_;
};

Renderer::Exposure::Exposure(const Impl& world, const Camera& camera, const SE3& T_world_camera,
                             double time_s, const RenderOptions& options)
    : world_(world), camera_(camera), options_(options) {
  std::vector<SE3> T_world_group = {SE3()};
  for (const Actor& actor : world.scene.actors) {
    const std::vector<SE3> poses = actor.poses(time_s);
    T_world_group.insert(T_world_group.end(), poses.begin(), poses.end());
  }
  for (const SE3& T : T_world_group) views_.push_back(make_view(camera, T_world_camera, T));
  if (world.scene.light) light_ = world.scene.light->at(time_s);
  rays_ = make_instance_scene(world.device, world.groups, T_world_group);
  projector_world_m_ = (T_world_camera * options.projector_camera_m.cast<double>()).cast<float>();
  const std::size_t count = static_cast<std::size_t>(camera.width_px) * camera.height_px;
  hits_.resize(count);
  result_.colours.resize(count);
  result_.pixels.resize(count);
}

Rendering Renderer::Exposure::take() {
  const int strips = (camera_.height_px + kPacketHeight - 1) / kPacketHeight;
  for_each_index(strips, options_.threads, [this](int strip) { trace_rows(strip); });
  for_each_index(camera_.height_px, options_.threads, [this](int y) {
    shade_row(y);
    smooth_edges_of_row(y);
  });
  return std::move(result_);
}

Renderer::Exposure::Hits Renderer::Exposure::trace(const PacketPixels& pixels,
                                                   bool coherent) const {
  alignas(32) std::array<int, kPacket> valid{};
  RTCRayHit8 rays;
  const View& view = views_.front();
  for (int i = 0; i < kPacket; ++i) {
    valid[i] = i < pixels.count ? -1 : 0;
    const Vector3 ray = view.direction(pixels.x[i], pixels.y[i]);
    rays.ray.org_x[i] = view.origin.x();
    rays.ray.org_y[i] = view.origin.y();
    rays.ray.org_z[i] = view.origin.z();
    rays.ray.dir_x[i] = ray.x();
    rays.ray.dir_y[i] = ray.y();
    rays.ray.dir_z[i] = ray.z();
    rays.ray.tnear[i] = kNear_m;
    rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
    rays.ray.time[i] = 0;
    rays.ray.mask[i] = ~0U;
    rays.ray.flags[i] = 0;
    rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  intersect(rays_.get(), valid.data(), rays, coherent);
  Hits hits;
  for (int i = 0; i < pixels.count; ++i) {
    if (rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    const unsigned group = rays.hit.instID[0][i];
    hits[i] = {&world_.surfaces[group][rays.hit.geomID[i]],
               group,
               rays.hit.primID[i],
               rays.hit.u[i],
               rays.hit.v[i],
               rays.ray.tfar[i]};
  }
  return hits;
}

void Renderer::Exposure::test_projector(const PacketPixels& pixels, const Hits& hits,
                                        bool* lit) const {
  constexpr float kMargin = 2e-3F;  // stop short of the surface itself
  alignas(32) std::array<int, kPacket> valid{};
  RTCRay8 rays;
  const View& view = views_.front();
  for (int i = 0; i < kPacket; ++i) {
    valid[i] = i < pixels.count && hits[i].surface != nullptr ? -1 : 0;
    const Vector3 p = view.origin + hits[i].depth_m * view.direction(pixels.x[i], pixels.y[i]);
    const Vector3 ray = p - projector_world_m_;
    rays.org_x[i] = projector_world_m_.x();
    rays.org_y[i] = projector_world_m_.y();
    rays.org_z[i] = projector_world_m_.z();
    rays.dir_x[i] = ray.x();
    rays.dir_y[i] = ray.y();
    rays.dir_z[i] = ray.z();
    rays.tnear[i] = 0.0F;
    rays.tfar[i] = 1.0F - kMargin;
    rays.time[i] = 0;
    rays.mask[i] = ~0U;
    rays.flags[i] = 0;
  }
  find_occluded(rays_.get(), valid.data(), rays, true);
  for (int i = 0; i < pixels.count; ++i) lit[i] = rays.tfar[i] >= 0;
}

void Renderer::Exposure::trace_rows(int strip) {
  const int y0 = strip * kPacketHeight;
  const int y1 = std::min(y0 + kPacketHeight, camera_.height_px);
  for (int x0 = 0; x0 < camera_.width_px; x0 += kPacketWidth) {
    const int x1 = std::min(x0 + kPacketWidth, camera_.width_px);
    PacketPixels pixels;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) pixels.add(static_cast<float>(x), static_cast<float>(y));
    }
    const Hits hits = trace(pixels, true);
    std::array<bool, kPacket> lit;
    lit.fill(true);
    if (options_.projector) test_projector(pixels, hits, lit.data());
    int i = 0;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x, ++i) {
        hits_[index(x, y)] = hits[i];
        result_.pixels[index(x, y)] = describe(hits[i], x, y);
        result_.pixels[index(x, y)].lit_by_projector = lit[i];
      }
    }
  }
}

RenderedPixel Renderer::Exposure::describe(const SurfaceHit& hit, int x, int y) const {
  RenderedPixel pixel;
  if (hit.surface == nullptr) return pixel;
  pixel.depth_m = hit.depth_m;
  pixel.object = hit.surface->object;
  pixel.moving = hit.surface->moving;
  const Vector3 ray =
      views_[hit.group].direction(static_cast<float>(x), static_cast<float>(y)).normalized();
  pixel.facing = std::abs(ray.dot(hit.surface->triangles[hit.triangle].normal));
  return pixel;
}

Eigen::Array3f Renderer::Exposure::colour(const SurfaceHit& hit, float x, float y,
                                          float footprint_px) const {
  if (hit.surface == nullptr) return Eigen::Array3f::Zero();
  return shade(world_.scene, light_ ? &*light_ : nullptr, hit, views_[hit.group], x, y,
               footprint_px);
}

void Renderer::Exposure::shade_row(int y) {
  for (int x = 0; x < camera_.width_px; ++x) {
    const int i = index(x, y);
    if (options_.edge_samples > 1 && is_edge(x, y)) continue;
    result_.colours[i] = colour(hits_[i], static_cast<float>(x), static_cast<float>(y), 1.0F);
  }
}

bool Renderer::Exposure::differ(const SurfaceHit& a, const SurfaceHit& b) const {
  if (a.surface != b.surface) return true;
  if (a.surface == nullptr || a.triangle == b.triangle) return false;
  constexpr float kFold = 0.9F;  // cosine between faces
  constexpr float kStep = 0.02F;
  const Vector3& n = a.surface->triangles[a.triangle].normal;
  return n.dot(b.surface->triangles[b.triangle].normal) < kFold ||
         std::abs(a.depth_m - b.depth_m) > kStep * a.depth_m;
}

bool Renderer::Exposure::is_edge(int x, int y) const {
  const SurfaceHit& hit = hits_[index(x, y)];
  return (x > 0 && differ(hit, hits_[index(x - 1, y)])) ||
         (y > 0 && differ(hit, hits_[index(x, y - 1)])) ||
         (x + 1 < camera_.width_px && differ(hit, hits_[index(x + 1, y)])) ||
         (y + 1 < camera_.height_px && differ(hit, hits_[index(x, y + 1)]));
}

void Renderer::Exposure::smooth_edges_of_row(int y) {
  if (options_.edge_samples <= 1) return;
  std::vector<int> columns;
  for (int x = 0; x < camera_.width_px; ++x) {
    if (is_edge(x, y)) columns.push_back(x);
  }
  smooth_edge_pixels(columns, y);
}

void Renderer::Exposure::smooth_edge_pixels(const std::vector<int>& columns, int y) {
  const int samples = options_.edge_samples;
  const float footprint = 1.0F / std::sqrt(static_cast<float>(samples));
  const int total = samples * static_cast<int>(columns.size());
  for (int first = 0; first < total; first += kPacket) {
    PacketPixels pixels;
    for (int s = first; s < std::min(first + kPacket, total); ++s) {
      const Vector2 offset = sub_pixel(s % samples, samples);
      pixels.add(static_cast<float>(columns[s / samples]) + offset.x(),
                 static_cast<float>(y) + offset.y());
    }
    const Hits hits = trace(pixels, false);
    for (int k = 0; k < pixels.count; ++k) {
      const int x = columns[(first + k) / samples];
      Eigen::Array3f& sum = result_.colours[index(x, y)];
      if ((first + k) % samples == 0) sum.setZero();
      sum += colour(hits[k], pixels.x[k], pixels.y[k], footprint) / static_cast<float>(samples);
    }
  }
}

Renderer::Renderer(Scene scene) : impl_(std::make_unique<const Impl>(std::move(scene))) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const Scene& Renderer::scene() const { return impl_->scene; }

Rendering Renderer::render(const Camera& camera, const SE3& T_world_camera, double time_s,
                           const RenderOptions& options) const {
  return Exposure(*impl_, camera, T_world_camera, time_s, options).take();
}

}  // namespace ydd::sim
