// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/annotation.h"

#include <algorithm>
#include <set>

#include <Eigen/Geometry>

namespace ydd::sim {
namespace {

constexpr std::size_t kProbeStride = 16;  // every so many vertices
constexpr double kStill_m_s = 0.02;

struct Extent {
  int x0 = 1 << 20, y0 = 1 << 20, x1 = 0, y1 = 0;
  int pixels = 0;

  void add(int x, int y) { join({x, y, x + 1, y + 1, 1}); }
  void join(const Extent& other) {
    x0 = std::min(x0, other.x0);
    y0 = std::min(y0, other.y0);
    x1 = std::max(x1, other.x1);
    y1 = std::max(y1, other.y1);
    pixels += other.pixels;
  }
  Box box() const {
    return {static_cast<float>(x0), static_cast<float>(y0), static_cast<float>(x1),
            static_cast<float>(y1)};
  }
};

}  // namespace

MotionProbe::MotionProbe(const Scene& scene) {
  for (const Actor& actor : scene.actors) {
    std::vector<BodyProbe>& bodies = actors_.emplace_back();
    for (const Body& body : actor.bodies) {
      BodyProbe& probe = bodies.emplace_back();
      for (const Part& part : body.parts) {
        probe.objects.push_back(part.object);
        for (std::size_t i = 0; i < part.mesh.positions.size(); i += kProbeStride) {
          probe.points_body.push_back(part.mesh.positions[i].cast<double>());
        }
      }
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3d& p : probe.points_body) box.extend(p);
      if (box.isEmpty()) continue;
      probe.middle_body = box.center();
      probe.volume_m3 = box.volume();
    }
  }
}

std::vector<bool> MotionProbe::moving_objects(const Scene& scene, double time_s,
                                              double interval_s) const {
  std::vector<bool> moving(scene.objects.size(), false);
  const auto mark = [&](int object) {
    for (; object >= 0; object = scene.objects[object].whole) moving[object] = true;
  };
  const double still_m = kStill_m_s * interval_s;
  for (std::size_t a = 0; a < actors_.size(); ++a) {
    const std::vector<SE3> before = scene.actors[a].poses(time_s - 0.5 * interval_s);
    const std::vector<SE3> after = scene.actors[a].poses(time_s + 0.5 * interval_s);
    for (std::size_t b = 0; b < actors_[a].size(); ++b) {
      const BodyProbe& probe = actors_[a][b];
      const bool moves = std::any_of(
          probe.points_body.begin(), probe.points_body.end(), [&](const Eigen::Vector3d& p) {
            return (after[b] * p - before[b] * p).squaredNorm() > still_m * still_m;
          });
      if (moves) std::for_each(probe.objects.begin(), probe.objects.end(), mark);
    }
  }
  return moving;
}

std::vector<std::optional<Eigen::Vector3d>> MotionProbe::middles(const Scene& scene,
                                                                 double time_s) const {
  struct Sum {
    Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
    double weight = 0;
  };
  constexpr double kFlat_m3 = 1e-6;  // what is flat counts too
  std::vector<Sum> sums(scene.objects.size());
  for (std::size_t a = 0; a < actors_.size(); ++a) {
    const std::vector<SE3> T = scene.actors[a].poses(time_s);
    for (std::size_t b = 0; b < actors_[a].size(); ++b) {
      const BodyProbe& probe = actors_[a][b];
      const double weight = probe.volume_m3 + kFlat_m3;
      std::set<int> objects;  // each once, however many parts it has on the body
      for (int object : probe.objects) {
        for (; object >= 0; object = scene.objects[static_cast<std::size_t>(object)].whole) {
          objects.insert(object);
        }
      }
      for (const int object : objects) {
        Sum& sum = sums[static_cast<std::size_t>(object)];
        sum.weighted += weight * (T[b] * probe.middle_body);
        sum.weight += weight;
      }
    }
  }
  std::vector<std::optional<Eigen::Vector3d>> out(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i].weight > 0) out[i] = sums[i].weighted / sums[i].weight;
  }
  return out;
}

std::vector<SimulatedObject> visible_objects(const Rendering& rendering, const Scene& scene,
                                             int width_px, const std::vector<bool>& moving,
                                             int min_pixels) {
  std::vector<Extent> extents(scene.objects.size());
  for (std::size_t i = 0; i < rendering.pixels.size(); ++i) {
    const int object = rendering.pixels[i].object;
    if (object < 0) continue;
    extents[object].add(static_cast<int>(i) % width_px, static_cast<int>(i) / width_px);
  }
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const int whole = scene.objects[i].whole;
    if (whole >= 0 && extents[i].pixels > 0) extents[whole].join(extents[i]);
  }
  std::vector<SimulatedObject> objects;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    if (extents[i].pixels < min_pixels) continue;
    const SceneObject& object = scene.objects[i];
    objects.push_back({object.class_name, object.name, object.id, moving[i], object.moving,
                       extents[i].box(), extents[i].pixels});
  }
  return objects;
}

Image<std::uint8_t> mover_mask(const Rendering& rendering, const Scene& scene,
                               const Camera& camera) {
  std::vector<std::uint8_t> ids;
  ids.reserve(rendering.pixels.size());
  for (const RenderedPixel& pixel : rendering.pixels) {
    // A statue is an actor whose object never moves.
    const bool mover = pixel.moving && pixel.object >= 0 && scene.objects[pixel.object].moving;
    ids.push_back(mover ? static_cast<std::uint8_t>(scene.objects[pixel.object].id) : 0);
  }
  return {camera.width_px, camera.height_px, std::move(ids)};
}

}  // namespace ydd::sim
