// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_blobs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_schema.h"

namespace ydd::map_format {
namespace {

void write(ByteWriter& out, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) out.f64(v[i]);
}

Eigen::Vector3d read_vector(ByteReader& in) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = in.f64();
  return v;
}

void write(ByteWriter& out, const Descriptor& descriptor) {
  for (const std::uint64_t word : descriptor) out.fixed(word);
}

Descriptor read_descriptor(ByteReader& in) {
  Descriptor descriptor;
  for (std::uint64_t& word : descriptor) word = in.fixed<std::uint64_t>();
  return descriptor;
}

MapPoint read_point(ByteReader& in) {
  MapPoint p;
  p.p_world = read_vector(in);
  p.normal = read_vector(in);
  p.min_distance_m = in.f64();
  p.max_distance_m = in.f64();
  p.descriptor = read_descriptor(in);
  p.born = static_cast<std::int64_t>(in.varint(INT64_MAX));
  p.visible = static_cast<int>(in.varint(UINT32_MAX));
  p.found = static_cast<int>(in.varint(UINT32_MAX));
  const std::size_t observations = in.count(3);
  for (std::size_t i = 0; i < observations; ++i) {
    const auto keyframe = in.id<KeyFrameId>();
    p.observations.push_back({keyframe, static_cast<int>(in.varint(INT32_MAX))});
  }
  return p;
}

}  // namespace

std::string encode_pose(const SE3& pose) {
  ByteWriter out;
  write(out, pose.translation());
  const Eigen::Quaterniond& q = pose.rotation();
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) out.f64(value);
  return std::move(out).take();
}

SE3 decode_pose(std::string_view bytes) {
  ByteReader in(bytes);
  const Eigen::Vector3d t = read_vector(in);
  Eigen::Quaterniond q;
  for (double* const value : {&q.x(), &q.y(), &q.z(), &q.w()}) *value = in.f64();
  in.expect_end();
  if (!(std::abs(q.squaredNorm() - 1.0) < 1e-9) || !t.allFinite()) {
    throw Fault("a pose that is no rigid motion");
  }
  return SE3::from_stored(q, t);
}

std::string encode_camera(const Camera& c) {
  ByteWriter out;
  out.varint(static_cast<std::uint64_t>(c.width_px));
  out.varint(static_cast<std::uint64_t>(c.height_px));
  for (const double value : {c.fx_px, c.fy_px, c.cx_px, c.cy_px, c.k1, c.k2, c.p1, c.p2, c.k3,
                             c.depth_scale, c.min_depth_m, c.max_depth_m, c.fps, c.baseline_m}) {
    out.f64(value);
  }
  return std::move(out).take();
}

Camera decode_camera(std::string_view bytes) {
  constexpr std::uint64_t kLargest_px = 100'000;
  Camera c;
  ByteReader in(bytes);
  c.width_px = static_cast<int>(in.varint(kLargest_px));
  c.height_px = static_cast<int>(in.varint(kLargest_px));
  for (double* const value :
       {&c.fx_px, &c.fy_px, &c.cx_px, &c.cy_px, &c.k1, &c.k2, &c.p1, &c.p2, &c.k3, &c.depth_scale,
        &c.min_depth_m, &c.max_depth_m, &c.fps, &c.baseline_m}) {
    *value = in.f64();
  }
  in.expect_end();
  // The same bounds as for a camera from a file.
  if (auto checked = check_camera(c); !checked) {
    throw Fault("a camera that cannot be: " + checked.error().message);
  }
  return c;
}

std::string encode_scales(const PyramidScales& scales) {
  ByteWriter out;
  out.f64(scales.log_step);
  out.varint(scales.factor.size());
  for (const double factor : scales.factor) out.f64(factor);
  for (const double information : scales.inv_sigma2) out.f64(information);
  return std::move(out).take();
}

PyramidScales decode_scales(std::string_view bytes) {
  PyramidScales scales;
  ByteReader in(bytes);
  scales.log_step = in.f64();
  const std::size_t levels = in.count(16);
  for (std::size_t i = 0; i < levels; ++i) scales.factor.push_back(in.f64());
  for (std::size_t i = 0; i < levels; ++i) scales.inv_sigma2.push_back(in.f64());
  in.expect_end();
  constexpr std::size_t kMostLevels = 32;
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (levels == 0 || levels > kMostLevels || !positive(scales.log_step) ||
      !std::ranges::all_of(scales.factor, positive) ||
      !std::ranges::all_of(scales.inv_sigma2, positive)) {
    throw Fault("an image pyramid that cannot be");
  }
  return scales;
}

std::string encode_features(const Features& f) {
  ByteWriter out(65U * f.size() + 10U);
  out.varint(f.size());
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Keypoint& k = f.keypoints[i];
    for (const float value : {k.x_px, k.y_px, k.angle_rad, k.response}) out.f32(value);
    out.fixed(static_cast<std::uint8_t>(k.octave));
    write(out, f.descriptors[i]);
    out.f32(f.undistorted_px[i].x());
    out.f32(f.undistorted_px[i].y());
    out.f32(f.depth_m[i]);
    out.f32(f.right_px[i]);
  }
  return std::move(out).take();
}

Features decode_features(std::string_view bytes) {
  Features f;
  ByteReader in(bytes);
  const std::size_t n = in.count(65);
  f.keypoints.reserve(n);
  f.descriptors.reserve(n);
  f.undistorted_px.reserve(n);
  f.depth_m.reserve(n);
  f.right_px.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    Keypoint k;
    for (float* const value : {&k.x_px, &k.y_px, &k.angle_rad, &k.response}) *value = in.f32();
    k.octave = in.fixed<std::uint8_t>();
    f.keypoints.push_back(k);
    f.descriptors.push_back(read_descriptor(in));
    const float x_px = in.f32();
    f.undistorted_px.emplace_back(x_px, in.f32());
    f.depth_m.push_back(in.f32());
    f.right_px.push_back(in.f32());
    // A grid is laid over them before the map as a whole is looked at.
    if (!f.undistorted_px.back().allFinite()) throw Fault("a keypoint that is nowhere");
  }
  in.expect_end();
  return f;
}

std::string encode_covisible(const std::vector<Covisible>& list) {
  ByteWriter out;
  out.varint(list.size());
  for (const Covisible& c : list) {
    out.id(c.keyframe);
    out.varint(static_cast<std::uint64_t>(c.weight));
  }
  return std::move(out).take();
}

std::vector<Covisible> decode_covisible(std::string_view bytes) {
  std::vector<Covisible> list;
  ByteReader in(bytes);
  const std::size_t n = in.count(3);
  for (std::size_t i = 0; i < n; ++i) {
    const auto keyframe = in.id<KeyFrameId>();
    list.push_back({keyframe, static_cast<int>(in.varint(INT32_MAX))});
  }
  in.expect_end();
  return list;
}

std::string encode_bag(const BagOfWords& bag) {
  ByteWriter out;
  out.varint(bag.words.size());
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < bag.words.size(); ++i) {
    out.varint(static_cast<std::uint64_t>(bag.words[i] - before));
    out.f32(bag.weights[i]);
    before = bag.words[i];
  }
  return std::move(out).take();
}

BagOfWords decode_bag(std::string_view bytes) {
  BagOfWords bag;
  ByteReader in(bytes);
  const std::size_t n = in.count(5);
  bag.words.resize(n);
  bag.weights.resize(n);
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t step = in.varint(UINT16_MAX);
    word += step;
    const float weight = in.f32();
    if ((i > 0 && step == 0) || word > UINT16_MAX || !(weight > 0) || !(weight <= 1.0F)) {
      throw Fault("words that cannot be");
    }
    bag.words[i] = static_cast<std::uint16_t>(word);
    bag.weights[i] = weight;
  }
  in.expect_end();
  return bag;
}

std::string encode_blocks_of(const std::vector<MapPointId>& points) {
  std::vector<std::uint32_t> blocks;
  blocks.reserve(points.size());
  for (const MapPointId id : points) {
    if (id.valid()) blocks.push_back(id.slot / kPointsPerBlock);
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  ByteWriter out;
  out.varint(blocks.size());
  std::uint32_t before = 0;
  for (const std::uint32_t block : blocks) out.varint(block - std::exchange(before, block));
  return std::move(out).take();
}

std::vector<std::uint32_t> decode_blocks(std::string_view bytes) {
  std::vector<std::uint32_t> blocks;
  ByteReader in(bytes);
  const std::size_t n = in.count(1);
  blocks.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t step = in.varint(UINT32_MAX);
    const std::uint64_t block = i == 0 ? step : blocks.back() + step;
    if ((i > 0 && step == 0) || block > UINT32_MAX / kPointsPerBlock) {
      throw Fault("blocks of points that cannot be");
    }
    blocks.push_back(static_cast<std::uint32_t>(block));
  }
  in.expect_end();
  return blocks;
}

template <class Tag>
std::string encode_ids(const std::vector<Id<Tag>>& ids) {
  ByteWriter out;
  out.varint(ids.size());
  for (const Id<Tag> id : ids) out.id(id);
  return std::move(out).take();
}

template <class Tag>
std::vector<Id<Tag>> decode_ids(std::string_view bytes) {
  std::vector<Id<Tag>> ids;
  ByteReader in(bytes);
  const std::size_t n = in.count(2);
  for (std::size_t i = 0; i < n; ++i) ids.push_back(in.id<Id<Tag>>());
  in.expect_end();
  return ids;
}

template std::string encode_ids(const std::vector<KeyFrameId>&);
template std::string encode_ids(const std::vector<MapPointId>&);
template std::vector<KeyFrameId> decode_ids<KeyFrameTag>(std::string_view);
template std::vector<MapPointId> decode_ids<MapPointTag>(std::string_view);

void PointBlock::add(MapPointId id, const MapPoint& p) {
  ByteWriter out;
  out.id(id);
  write(out, p.p_world);
  write(out, p.normal);
  out.f64(p.min_distance_m);
  out.f64(p.max_distance_m);
  write(out, p.descriptor);
  out.varint(static_cast<std::uint64_t>(p.born));
  out.varint(static_cast<std::uint32_t>(p.visible));
  out.varint(static_cast<std::uint32_t>(p.found));
  out.varint(p.observations.size());
  for (const Observation& s : p.observations) {
    out.id(s.keyframe);
    out.varint(static_cast<std::uint64_t>(s.keypoint));
  }
  bytes_ += std::move(out).take();
}

std::string PointBlock::take() { return std::exchange(bytes_, {}); }

void decode_points(std::string_view bytes, std::vector<std::pair<MapPointId, MapPoint>>& out) {
  ByteReader in(bytes);
  while (!in.done()) {
    const auto id = in.id<MapPointId>();
    out.emplace_back(id, read_point(in));
  }
}

}  // namespace ydd::map_format
