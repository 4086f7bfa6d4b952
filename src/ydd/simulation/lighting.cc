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
constexpr float kWindowReach_m = 7.0F;

float sky(float ambient, const Vector3& n) { return ambient * (0.82F + 0.18F * n.z()); }

/// Lambert's law, `to_lamp` from the surface to a point on the lamp.
float lamp_share(const Lamp& lamp, const Vector3& to_lamp, const Vector3& n, float reach_m) {
  const float distance2 = to_lamp.squaredNorm();
  if (distance2 > reach_m * reach_m || distance2 < 1e-4F) return 0;
  const float inverse = 1.0F / std::sqrt(distance2);
  const float up = lamp.facing.isZero() ? 1.0F : -lamp.facing.dot(to_lamp) * inverse;
  const float facing = n.dot(to_lamp) * inverse;
  if (up <= 0 || facing <= 0) return 0;
  return lamp.power * up * facing / distance2;
}

/// The i-th of `kLampRays` points on a lamp, from its centre.
Vector3 lamp_corner(const Lamp& lamp, int i) {
  const float a = (i & 1) != 0 ? 0.5F : -0.5F;
  const float b = (i & 2) != 0 ? 0.5F : -0.5F;
  const bool level = lamp.facing.x() == 0;
  return Vector3(a, level ? b : a, level ? 0.0F : b).cwiseProduct(lamp.half_size);
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

/// How much of the sky is not hidden by what is near; corners are darker.
float sky_share(RTCScene fixed, const Vector3& from, const Vector3& n) {
  int open = 0;
  for (const Vector3& direction : sky_directions(n)) {
    open += occluded(fixed, from, direction, kSkyReach_m) ? 0 : 1;
  }
  const float openness = static_cast<float>(open) / kSkyRays;
  return 0.35F + 0.65F * openness;
}

/// `light`, and what the lamps add to it.
float add_lamps(const std::vector<Lamp>& lamps, RTCScene fixed, const Vector3& from,
                const Vector3& n, float reach_m, float light) {
  for (const Lamp& lamp : lamps) {
    for (int i = 0; i < kLampRays; ++i) {
      const Vector3 ray = lamp.centre + lamp_corner(lamp, i) - from;
      const float share = lamp_share(lamp, ray, n, reach_m) / kLampRays;
      if (share > 0.002F && !occluded(fixed, from, ray, 0.99F)) light += share;
    }
  }
  return light;
}

float light_at(const Scene& scene, RTCScene fixed, const Vector3& p, const Vector3& n) {
  const Vector3 from = p + kLift_m * n;
  const float light = sky(scene.ambient, n) * sky_share(fixed, from, n);
  return add_lamps(scene.lamps, fixed, from, n, kLampReach_m, light);
}

/// Whether the sun reaches a surface through one of the windows, which lie in the west.
float sun_at(const Scene& scene, RTCScene fixed, const Vector3& from, const Vector3& n) {
  const Vector3& to_sun = scene.light->to_sun;
  const float facing = n.dot(to_sun);
  if (facing <= 0 || to_sun.x() >= 0) return 0;
  for (const Lamp& window : scene.windows) {
    const float reach_m = (window.centre.x() - from.x()) / to_sun.x();
    if (reach_m <= 0 || reach_m > kWindowReach_m) continue;
    const Vector3 off = from + reach_m * to_sun - window.centre;
    const Vector3 half = 0.5F * window.half_size;
    if (std::abs(off.y()) > half.y() || std::abs(off.z()) > half.z()) continue;
    if (!occluded(fixed, from, to_sun, 0.99F * reach_m)) return facing;
  }
  return 0;
}

/// `share` by source, of a place with these shares of sky and sun.
template <class AddLamps>
SourceShares shares_of(const Scene& scene, float sky_of_one, float sun, const AddLamps& lamps) {
  SourceShares shares{};
  const auto set = [&](LightSource source, float share) {
    shares[static_cast<std::size_t>(source)] = share;
  };
  set(LightSource::sky, sky_of_one);
  set(LightSource::ceiling, lamps(scene.lamps, kLampReach_m));
  set(LightSource::window, lamps(scene.windows, kWindowReach_m));
  set(LightSource::sun, sun);
  set(LightSource::desk, lamps(scene.desk_lamps, kLampReach_m));
  return shares;
}

SourceShares shares_at(const Scene& scene, RTCScene fixed, const Vector3& p, const Vector3& n) {
  const Vector3 from = p + kLift_m * n;
  return shares_of(scene, sky(1.0F, n) * sky_share(fixed, from, n), sun_at(scene, fixed, from, n),
                   [&](const std::vector<Lamp>& lamps, float reach_m) {
                     return add_lamps(lamps, fixed, from, n, reach_m, 0.0F);
                   });
}

}  // namespace

float open_light(const Scene& scene, const Vector3& p, const Vector3& n) {
  float light = sky(scene.ambient, n);
  for (const Lamp& lamp : scene.lamps) light += lamp_share(lamp, lamp.centre - p, n, kLampReach_m);
  return light;
}

SourceShares open_shares(const Scene& scene, const Vector3& p, const Vector3& n) {
  return shares_of(scene, sky(1.0F, n), 0.0F, [&](const std::vector<Lamp>& lamps, float reach_m) {
    float light = 0;
    for (const Lamp& lamp : lamps) light += lamp_share(lamp, lamp.centre - p, n, reach_m);
    return light;
  });
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

std::vector<std::vector<SourceShares>> bake_shares(const Scene& scene, const RayScene& fixed) {
  std::vector<std::vector<SourceShares>> shares;
  for (const Part& part : scene.fixed) {
    std::vector<SourceShares>& of_part = shares.emplace_back();
    if (part.glow > 0) continue;
    for (std::size_t i = 0; i < part.mesh.positions.size(); ++i) {
      of_part.push_back(
          shares_at(scene, fixed.get(), part.mesh.positions[i], part.mesh.normals[i]));
    }
  }
  return shares;
}

}  // namespace ydd::sim
