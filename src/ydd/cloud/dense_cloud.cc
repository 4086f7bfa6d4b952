// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/dense_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include <fmt/format.h>

#include "ydd/cloud/keyframe_picture.h"

namespace ydd {
namespace {

constexpr double kMetresPerCount = 0.001;
constexpr Bgr kGrey = {128, 128, 128};
// Two readings of one surface agree within the larger of these: pose error and depth noise.
constexpr double kTolerance_m = 0.08;
constexpr double kToleranceShare = 0.04;

/// Depth pictures of a map's keyframes and how to look at them.
class Pictures {
 public:
  static Result<Pictures> open(const Atlas& atlas, MapId map) {
    Pictures out(atlas.camera());
    std::string fault;
    atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
      if (keyframe.map != map || !keyframe.picture) return;
      Result<OpenPicture> picture = open_keyframe_picture(*keyframe.picture);
      if (!picture) {
        fault = fmt::format("picture of keyframe {}: {}", id.slot, picture.error().message);
        return;
      }
      out.order_.push_back(id);
      // Colour is decoded again when its turn comes: depth is what neighbours are asked for.
      out.depth_mm_.emplace(id, std::move(picture->depth_mm));
    });
    if (!fault.empty()) return Error{std::move(fault)};
    return out;
  }

  const std::vector<KeyFrameId>& order() const { return order_; }
  const RawDepthImage* depth_mm(KeyFrameId id) const {
    const auto found = depth_mm_.find(id);
    return found == depth_mm_.end() ? nullptr : &found->second;
  }

  /// Direction with z = 1 of a pixel of the small picture.
  Eigen::Vector3d ray(const RawDepthImage& depth_mm, int x, int y) {
    if (rays_.empty()) make_rays(depth_mm.width(), depth_mm.height());
    const Eigen::Vector2f& xy = rays_[static_cast<std::size_t>(y) * depth_mm.width() + x];
    return {xy.x(), xy.y(), 1.0};
  }

  /// What a picture reads where the point would be seen; 0: nothing, or out of sight.
  double reading_m(const RawDepthImage& depth_mm, const Eigen::Vector3d& p_camera) const {
    if (p_camera.z() <= 0.1) return 0;
    Eigen::Vector2d px = camera_.project(p_camera);
    if (camera_.has_distortion()) px = camera_.distort(px);
    // The centre of small pixel x lies at 2 x + 0.5 of the image.
    const int x = static_cast<int>(std::lround((px.x() - 0.5) / 2.0));
    const int y = static_cast<int>(std::lround((px.y() - 0.5) / 2.0));
    return depth_mm.contains(x, y) ? depth_mm(x, y) * kMetresPerCount : 0.0;
  }

 private:
  explicit Pictures(const Camera& camera) : camera_(camera) {}

  void make_rays(int width, int height) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Eigen::Vector3d p =
            camera_.unproject(camera_.undistort({2.0 * x + 0.5, 2.0 * y + 0.5}), 1.0);
        rays_.emplace_back(p.head<2>().cast<float>());
      }
    }
  }

  Camera camera_;
  std::vector<KeyFrameId> order_;
  std::unordered_map<KeyFrameId, RawDepthImage> depth_mm_;
  std::vector<Eigen::Vector2f> rays_;
};

/// A covisible keyframe that is asked about points.
struct Witness {
  const RawDepthImage* depth_mm = nullptr;
  SE3 T_camera_world;
};

struct Witnesses {
  std::vector<Witness> nearest;  ///< that share most points
  std::vector<Witness> latest;   ///< that came after the keyframe, the last one first
};

Witnesses witnesses_of(const Atlas& atlas, const KeyFrame& keyframe, const Pictures& pictures,
                       const DenseCloudOptions& options) {
  Witnesses out;
  std::vector<std::pair<std::int64_t, Witness>> later;
  for (const Covisible& c : keyframe.covisible) {
    const RawDepthImage* const depth_mm = pictures.depth_mm(c.keyframe);
    if (!depth_mm) continue;
    const KeyFrame& other = atlas.at(c.keyframe);
    const Witness witness{depth_mm, other.T_world_camera.inverse()};
    if (static_cast<int>(out.nearest.size()) < options.witnesses) out.nearest.push_back(witness);
    if (other.serial > keyframe.serial) later.emplace_back(other.serial, witness);
  }
  std::sort(later.begin(), later.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [serial, witness] : later) {
    if (static_cast<int>(out.latest.size()) >= options.latest_witnesses) break;
    out.latest.push_back(witness);
  }
  return out;
}

enum class Testimony { none, sees, looks_through };

Testimony ask(const Pictures& pictures, const Witness& witness, const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p_camera = witness.T_camera_world * p_world;
  const double reading_m = pictures.reading_m(*witness.depth_mm, p_camera);
  const double tolerance_m = std::max(kTolerance_m, kToleranceShare * p_camera.z());
  if (reading_m <= 0 || reading_m < p_camera.z() - tolerance_m) return Testimony::none;
  return reading_m > p_camera.z() + tolerance_m ? Testimony::looks_through : Testimony::sees;
}

/// Whether more of the nearest witnesses look through the point than see it.
bool stood_never(const Pictures& pictures, const std::vector<Witness>& nearest,
                 const Eigen::Vector3d& p_world) {
  int balance = 0;
  for (const Witness& w : nearest) {
    const Testimony says = ask(pictures, w, p_world);
    balance += says == Testimony::sees ? 1 : says == Testimony::looks_through ? -1 : 0;
  }
  return balance < 0;
}

/// Whether the last who say anything of the point look through it.
bool is_gone(const Pictures& pictures, const std::vector<Witness>& latest,
             const Eigen::Vector3d& p_world) {
  constexpr int kSure = 2;
  int through = 0;
  for (const Witness& w : latest) {
    const Testimony says = ask(pictures, w, p_world);
    if (says == Testimony::sees) return false;
    through += says == Testimony::looks_through ? 1 : 0;
    if (through >= kSure) return true;
  }
  return false;
}

Result<KeyframeCloud> cloud_of(const Atlas& atlas, KeyFrameId id, Pictures& pictures,
                               const DenseCloudOptions& options) {
  const KeyFrame& keyframe = atlas.at(id);
  const Result<OpenPicture> picture = open_keyframe_picture(*keyframe.picture);
  if (!picture) return picture.error();
  const auto witnesses = witnesses_of(atlas, keyframe, pictures, options);
  const bool grey = options.redact && !people_left_out(*keyframe.picture);
  const RawDepthImage& depth_mm = picture->depth_mm;
  KeyframeCloud cloud{id, keyframe.T_world_camera.translation().cast<float>(), {}};
  for (int y = 0; y < depth_mm.height(); ++y) {
    for (int x = 0; x < depth_mm.width(); ++x) {
      const double depth_m = depth_mm(x, y) * kMetresPerCount;
      if (depth_m <= 0 || depth_m > options.max_depth_m) continue;
      const Eigen::Vector3d p_world =
          keyframe.T_world_camera * (depth_m * pictures.ray(depth_mm, x, y));
      if (stood_never(pictures, witnesses.nearest, p_world)) continue;
      if (is_gone(pictures, witnesses.latest, p_world)) continue;
      cloud.points.push_back({p_world.cast<float>(), grey ? kGrey : picture->colour(x, y)});
    }
  }
  return cloud;
}

/// Sums over a cube.
struct Cube {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  std::array<std::uint32_t, 3> colour{};
  std::uint32_t count = 0;
};

/// Cube numbers side by side, so that their order is that of x, then y, then z.
std::uint64_t cube_of(const Eigen::Vector3f& p_world, double voxel_m) {
  constexpr std::int64_t kMiddle = std::int64_t{1} << 20U;
  std::uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    const auto n = static_cast<std::int64_t>(std::floor(static_cast<double>(p_world[i]) / voxel_m));
    key = key << 21U |
          static_cast<std::uint64_t>(std::clamp(n + kMiddle, std::int64_t{0}, 2 * kMiddle - 1));
  }
  return key;
}

CloudPoint mean_of(const Cube& cube) {
  CloudPoint point;
  point.p_world = (cube.p_world / cube.count).cast<float>();
  for (std::size_t c = 0; c < 3; ++c) {
    point.colour[c] = static_cast<std::uint8_t>((cube.colour[c] + cube.count / 2) / cube.count);
  }
  return point;
}

}  // namespace

Result<void> for_each_keyframe_cloud(const Atlas& atlas, MapId map,
                                     const DenseCloudOptions& options,
                                     const std::function<void(const KeyframeCloud&)>& visit) {
  Result<Pictures> pictures = Pictures::open(atlas, map);
  if (!pictures) return pictures.error();
  for (const KeyFrameId id : pictures->order()) {
    const Result<KeyframeCloud> cloud = cloud_of(atlas, id, *pictures, options);
    if (!cloud) return cloud.error();
    visit(*cloud);
  }
  return {};
}

Result<std::vector<CloudPoint>> dense_cloud(const Atlas& atlas, MapId map,
                                            const DenseCloudOptions& options) {
  std::unordered_map<std::uint64_t, Cube> cubes;
  const auto add = [&](const KeyframeCloud& cloud) {
    for (const CloudPoint& point : cloud.points) {
      Cube& cube = cubes[cube_of(point.p_world, options.voxel_m)];
      cube.p_world += point.p_world.cast<double>();
      for (std::size_t c = 0; c < 3; ++c) cube.colour[c] += point.colour[c];
      ++cube.count;
    }
  };
  if (auto done = for_each_keyframe_cloud(atlas, map, options, add); !done) return done.error();
  std::vector<std::uint64_t> order;
  order.reserve(cubes.size());
  for (const auto& [key, cube] : cubes) order.push_back(key);
  std::sort(order.begin(), order.end());
  std::vector<CloudPoint> out;
  out.reserve(order.size());
  for (const std::uint64_t key : order) out.push_back(mean_of(cubes.at(key)));
  return out;
}

}  // namespace ydd
