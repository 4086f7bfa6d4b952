// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/shading.h"

#include <cmath>

#include "ydd/simulation/lighting.h"

namespace ydd::sim {
namespace {

/// Movement of the point that the ray through (x, y) meets, when the ray moves by `step` (ray
/// differentials of a plane, Igehy 1999, eq. 10-12).
Vector3 slide(const Vector3& normal, const Vector3& ray, float depth_m, const Vector3& step) {
  float facing = normal.dot(ray);
  constexpr float kGrazing = 1e-3F;
  if (std::abs(facing) < kGrazing) facing = std::copysign(kGrazing, facing);
  return depth_m * (step - ray * (normal.dot(step) / facing));
}

/// A smooth normal, and where the hit is, in the world frame.
struct WorldHit {
  Vector3 p, n;
};

WorldHit in_world(const SurfaceHit& hit, const View& view, const Vector3& ray) {
  const auto& n = hit.surface->normals[hit.triangle];
  const Vector3 smooth = (1.0F - hit.b - hit.c) * n[0] + hit.b * n[1] + hit.c * n[2];
  const Vector3 p = view.rotation_world * (view.origin + hit.depth_m * ray);
  return {p + view.translation_world, (view.rotation_world * smooth).normalized()};
}

Eigen::Array3f changing_light(const Scene& scene, const LightNow& now, const SurfaceHit& hit,
                              const View& view, const Vector3& ray) {
  const Surface& surface = *hit.surface;
  if (surface.glow > 0) {
    constexpr float kSwitchedOff = 0.12F;  // what else falls on a window and a ceiling lamp
    const Eigen::Array3f& on = now.sources[static_cast<std::size_t>(surface.source)];
    return surface.glow * on.max(kSwitchedOff);
  }
  SourceShares shares{};
  if (surface.moving) {
    const WorldHit at = in_world(hit, view, ray);
    shares = open_shares(scene, at.p, at.n);
  } else {
    const auto& corner = surface.shares[hit.triangle];
    for (std::size_t i = 0; i < shares.size(); ++i) {
      shares[i] =
          (1.0F - hit.b - hit.c) * corner[0][i] + hit.b * corner[1][i] + hit.c * corner[2][i];
    }
  }
  Eigen::Array3f light = Eigen::Array3f::Zero();
  for (std::size_t i = 0; i < shares.size(); ++i) light += shares[i] * now.sources[i];
  return light;
}

}  // namespace

Surface make_surface(const Part& part, const std::vector<Texture>& textures,
                     const std::vector<float>& vertex_light,
                     const std::vector<SourceShares>& vertex_shares) {
  Surface surface;
  surface.source = part.source;
  surface.texture = &textures.at(part.texture);
  surface.object = part.object;
  surface.glow = part.glow;
  surface.moving = vertex_light.empty();
  const Mesh& mesh = part.mesh;
  for (const auto& [a, b, c] : mesh.triangles) {
    ShadingTriangle t;
    const auto texel = [&](std::uint32_t v) -> Vector2 {
      return mesh.uvs[v].cwiseProduct(part.texels_per_uv);
    };
    t.uv = texel(a);
    t.uv_by_b = texel(b) - t.uv;
    t.uv_by_c = texel(c) - t.uv;
    const Vector3 e1 = mesh.positions[b] - mesh.positions[a];
    const Vector3 e2 = mesh.positions[c] - mesh.positions[a];
    const Vector3 cross = e1.cross(e2);
    const float area2 = std::max(cross.squaredNorm(), 1e-16F);
    t.normal = cross / std::sqrt(area2);
    if (t.normal.dot(mesh.normals[a]) < 0) t.normal = -t.normal;
    // Dual basis of the edges: e1 . d1 = 1, e2 . d1 = 0, and so on.
    const Vector3 d1 = e2.cross(cross) / area2;
    const Vector3 d2 = cross.cross(e1) / area2;
    t.u_gradient = t.uv_by_b.x() * d1 + t.uv_by_c.x() * d2;
    t.v_gradient = t.uv_by_b.y() * d1 + t.uv_by_c.y() * d2;
    if (!surface.moving) {
      t.light = vertex_light[a];
      t.light_by_b = vertex_light[b] - t.light;
      t.light_by_c = vertex_light[c] - t.light;
    } else {
      surface.normals.push_back({mesh.normals[a], mesh.normals[b], mesh.normals[c]});
    }
    surface.triangles.push_back(t);
    if (!vertex_shares.empty()) {
      surface.shares.push_back({vertex_shares[a], vertex_shares[b], vertex_shares[c]});
    }
  }
  return surface;
}

Eigen::Array3f shade(const Scene& scene, const LightNow* now, const SurfaceHit& hit,
                     const View& view, float x, float y, float footprint_px) {
  const Surface& surface = *hit.surface;
  const ShadingTriangle& t = surface.triangles[hit.triangle];
  const Vector2 uv = t.uv + hit.b * t.uv_by_b + hit.c * t.uv_by_c;
  const Vector3 ray = view.direction(x, y);
  const Vector3 along_x = footprint_px * slide(t.normal, ray, hit.depth_m, view.step_x);
  const Vector3 along_y = footprint_px * slide(t.normal, ray, hit.depth_m, view.step_y);
  const Footprint footprint{{t.u_gradient.dot(along_x), t.v_gradient.dot(along_x)},
                            {t.u_gradient.dot(along_y), t.v_gradient.dot(along_y)}};
  if (now != nullptr) {
    return changing_light(scene, *now, hit, view, ray) *
           surface.texture->sample(uv.x(), uv.y(), footprint);
  }
  float light = surface.glow;
  if (!surface.moving) {
    light = t.light + hit.b * t.light_by_b + hit.c * t.light_by_c;
  } else if (light <= 0) {
    const WorldHit at = in_world(hit, view, ray);
    light = open_light(scene, at.p, at.n);
  }
  return light * surface.texture->sample(uv.x(), uv.y(), footprint);
}

}  // namespace ydd::sim
