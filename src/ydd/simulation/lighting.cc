// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/lighting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ydd::sim {
namespace {

constexpr float kLift_m = 0.01F;  // start above the surface: it must not shade itself
constexpr int kSkyRays = 16;
constexpr int kLampRays = 4;
constexpr float kSkyReach_m = 1.0F;  // occluders farther away do not darken: walls reflect
constexpr float kLampReach_m = 4.5F;

float sky(float ambient, const Vector3& n) { return ambient * (0.82F + 0.18F * n.z()); }

/// Lambert's law for a lamp that shines downwards, `to_lamp` from the surface to a point on it.
float lamp_share(const Lamp& lamp, const Vector3& to_lamp, const Vector3& n) {
  const float distance2 = to_lamp.squaredNorm();
  if (distance2 > kLampReach_m * kLampReach_m || distance2 < 1e-4F) return 0;
  const float inverse = 1.0F / std::sqrt(distance2);
  const float up = to_lamp.z() * inverse;
  const float facing = n.dot(to_lamp) * inverse;
  if (up <= 0 || facing <= 0) return 0;
  return lamp.power * up * facing / distance2;
}

bool occluded(RTCScene scene, const Vector3& from, const Vector3& ray, float reach) {
  RTCRay r{};
  r.org_x = from.x();
  r.org_y = from.y();
  r.org_z = from.z();
  r.dir_x = ray.x();
  r.dir_y = ray.y();
  r.dir_z = ray.z();
  r.tnear = 0.0F;
  r.tfar = reach;
  r.mask = ~0U;
  find_occluded(scene, r);
  return r.tfar < 0;
}

/// Directions about n, distributed as its cosine; the same for all points, so that light is smooth.
std::array<Vector3, kSkyRays> sky_directions(const Vector3& n) {
  const Vector3 helper = std::abs(n.x()) < 0.7F ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 a = n.cross(helper).normalized();
  const Vector3 b = n.cross(a);
  std::array<Vector3, kSkyRays> directions;
  for (int i = 0; i < kSkyRays; ++i) {
    const float height2 = (static_cast<float>(i) + 0.5F) / kSkyRays;
    const float angle = 2.39996F * static_cast<float>(i);  // golden angle
    const float radius = std::sqrt(1.0F - height2);
    directions[i] = radius * (std::cos(angle) * a + std::sin(angle) * b) + std::sqrt(height2) * n;
  }
  return directions;
}

float light_at(const Scene& scene, RTCScene fixed, const Vector3& p, const Vector3& n) {
  const Vector3 from = p + kLift_m * n;
  int open = 0;
  for (const Vector3& direction : sky_directions(n)) {
    open += occluded(fixed, from, direction, kSkyReach_m) ? 0 : 1;
  }
  const float openness = static_cast<float>(open) / kSkyRays;
  float light = sky(scene.ambient, n) * (0.35F + 0.65F * openness);
  for (const Lamp& lamp : scene.lamps) {
    for (int i = 0; i < kLampRays; ++i) {
      const Vector3 corner((i & 1) != 0 ? 0.5F : -0.5F, (i & 2) != 0 ? 0.5F : -0.5F, 0);
      const Vector3 ray = lamp.centre + corner.cwiseProduct(lamp.half_size) - from;
      const float share = lamp_share(lamp, ray, n) / kLampRays;
      if (share > 0.002F && !occluded(fixed, from, ray, 0.99F)) light += share;
    }
  }
  return light;
}

}  // namespace

float open_light(const Scene& scene, const Vector3& p, const Vector3& n) {
  float light = sky(scene.ambient, n);
  for (const Lamp& lamp : scene.lamps) light += lamp_share(lamp, lamp.centre - p, n);
  return light;
}

std::vector<std::vector<float>> bake_light(const Scene& scene, const RayScene& fixed) {
  std::vector<std::vector<float>> lights;
  for (const Part& part : scene.fixed) {
    std::vector<float>& light = lights.emplace_back();
    for (std::size_t i = 0; i < part.mesh.positions.size(); ++i) {
      light.push_back(part.glow > 0 ? part.glow
                                    : light_at(scene, fixed.get(), part.mesh.positions[i],
                                               part.mesh.normals[i]));
    }
  }
  return lights;
}

}  // namespace ydd::sim
