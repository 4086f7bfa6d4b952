// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/found_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "ydd/base/interruption.h"
#include "ydd/evidence/motion_evidence.h"
#include "ydd/simulation/depth_sensor.h"

namespace ydd {
namespace {

constexpr int kWidth_px = 320, kHeight_px = 240;
constexpr double kFrame_s = 1.0 / 30.0;
constexpr int kStartFrame = 15;  // of the mover
constexpr double kDensity_per_m2 = 120;
constexpr double kMarkSigma_px = 0.5;
constexpr int kAlarmCells = 20;

using Eigen::Vector3d;

/// An axis-parallel box; walls and floor are flat ones.
struct Block {
  Vector3d low, high;
  bool moves = false;
};

/// A point that the extractor would find again.
struct Mark {
  Vector3d p;
  int block = 0;
  Descriptor descriptor{};
};

Camera study_camera() {
  Camera camera;
  camera.width_px = kWidth_px;
  camera.height_px = kHeight_px;
  camera.fx_px = camera.fy_px = 267;
  camera.cx_px = 159.5;
  camera.cy_px = 119.5;
  camera.min_depth_m = 0.4;
  camera.max_depth_m = 5.0;
  return camera;
}

/// World frame: that of the first camera (x right, y down, z forward).
std::vector<Block> room(const MoverOptions& mover) {
  std::vector<Block> blocks = {
      {{-4, -2, 4.0}, {4, 1.2, 4.1}},        // wall ahead
      {{-2.6, -2, -1}, {-2.5, 1.2, 4.1}},    // wall to the left
      {{-4, 1.2, -1}, {4, 1.3, 4.1}},        // floor
      {{-1.9, 0.5, 2.6}, {-0.6, 1.2, 3.3}},  // desk
      {{0.9, -0.4, 2.9}, {1.6, 1.2, 3.5}},   // shelf
  };
  const double half_m = mover.side_m / 2;
  if (half_m > 0) {
    blocks.push_back({{-half_m, -half_m, mover.distance_m},
                      {half_m, half_m, mover.distance_m + mover.side_m},
                      true});
  }
  return blocks;
}

/// Points on all faces of all blocks.
std::vector<Mark> make_marks(const std::vector<Block>& blocks, std::mt19937& random) {
  std::vector<Mark> marks;
  std::uniform_real_distribution<double> share(0, 1);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Vector3d size = blocks[b].high - blocks[b].low;
    for (int axis = 0; axis < 3; ++axis) {
      const double area_m2 = size[(axis + 1) % 3] * size[(axis + 2) % 3];
      for (const bool far : {false, true}) {
        const int count = static_cast<int>(area_m2 * kDensity_per_m2);
        for (int i = 0; i < count; ++i) {
          Mark mark;
          mark.block = static_cast<int>(b);
          for (int k = 0; k < 3; ++k) mark.p[k] = blocks[b].low[k] + share(random) * size[k];
          mark.p[axis] = far ? blocks[b].high[axis] : blocks[b].low[axis];
          for (std::uint64_t& word : mark.descriptor) {
            const std::uint64_t upper = random();
            word = (upper << 32U) | random();
          }
          marks.push_back(mark);
        }
      }
    }
  }
  return marks;
}

/// Where the ray enters the block; infinite if it does not.
double entry_m(const Block& block, const Vector3d& from, const Vector3d& ray) {
  double enter = 0, leave = 1e9;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(ray[k]) < 1e-12) {
      if (from[k] < block.low[k] || from[k] > block.high[k]) return 1e9;
      continue;
    }
    const double a = (block.low[k] - from[k]) / ray[k], b = (block.high[k] - from[k]) / ray[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave && enter > 0 ? enter : 1e9;
}

struct Seen {
  std::vector<float> exact_m;
  std::vector<int> block;  ///< of each pixel; -1: none
};

Seen cast_rays(const std::vector<Block>& blocks, const Camera& camera, const SE3& T_world_camera) {
  Seen seen;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const Vector3d ray =
          T_world_camera.rotation() * camera.unproject({double(x), double(y)}, 1.0);
      double nearest_m = 1e9;
      int hit = -1;
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        const double m = entry_m(blocks[b], T_world_camera.translation(), ray);
        if (m >= nearest_m) continue;
        nearest_m = m;
        hit = static_cast<int>(b);
      }
      seen.exact_m.push_back(hit < 0 ? 0.0F : static_cast<float>(nearest_m));
      seen.block.push_back(hit);
    }
  }
  return seen;
}

DepthImage sensed(const Seen& seen, const Camera& camera, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<float> depth_m;
  depth_m.reserve(seen.exact_m.size());
  for (const float exact_m : seen.exact_m) {
    const double m = exact_m + normal(random) * sim::kinect_noise_m(exact_m);
    depth_m.push_back(exact_m > 0 && camera.is_valid_depth(m) ? static_cast<float>(m) : 0.0F);
  }
  return {kWidth_px, kHeight_px, std::move(depth_m)};
}

/// What an extractor finds of the marks that are in view.
Features features_of(const std::vector<Mark>& marks, const Vector3d& mover_shift_m,
                     const std::vector<Block>& blocks, const Seen& seen, const DepthImage& depth_m,
                     const Camera& camera, const SE3& T_world_camera, std::mt19937& random) {
  std::normal_distribution<double> noise_px(0, kMarkSigma_px);
  const SE3 T_camera_world = T_world_camera.inverse();
  OrbFeatures found;
  for (const Mark& mark : marks) {
    const bool moves = blocks[static_cast<std::size_t>(mark.block)].moves;
    const Vector3d p = T_camera_world * (moves ? mark.p + mover_shift_m : mark.p);
    if (p.z() < 0.1) continue;
    const Eigen::Vector2d px = camera.project(p);
    const int x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
    if (!depth_m.contains(x, y)) continue;
    const float surface_m = seen.exact_m[static_cast<std::size_t>(y) * kWidth_px + x];
    const bool hidden = std::abs(surface_m - p.z()) > 0.03 * p.z();
    if (hidden || random() % 4 == 0) continue;  // no extractor finds everything again
    found.keypoints.push_back({static_cast<float>(px.x() + noise_px(random)),
                               static_cast<float>(px.y() + noise_px(random)), 0, 1, 0});
    Descriptor descriptor = mark.descriptor;
    for (int flip = 0; flip < 12; ++flip)
      descriptor[random() % 4] ^= std::uint64_t{1} << (random() % 64U);
    found.descriptors.push_back(descriptor);
  }
  return with_geometry(std::move(found), camera, depth_m);
}

/// Carried by hand: slow sways that start at rest.
SE3 camera_at(double time_s, double speed_m_s, std::uint32_t seed) {
  const double w = 2 * std::numbers::pi * 0.4, phase = 0.3 * seed;
  const double reach_m = speed_m_s / w;
  const auto sway = [&](double k) { return std::sin(k * w * time_s + phase) - std::sin(phase); };
  Vector6d twist;
  twist << reach_m * sway(1), 0.5 * reach_m * sway(0.7), 0.7 * reach_m * sway(0.9),
      0.03 * sway(0.8), 0.05 * sway(0.6), 0.01 * sway(1);
  return SE3::exp(twist);
}

struct Counted {
  int mover = 0, mover_found = 0, room = 0, room_false = 0;
};

/// Cells that show one block only, by what they show and how they were judged.
Counted count_cells(const MotionOdds& odds, const Seen& seen, const std::vector<Block>& blocks) {
  Counted out;
  const CellGrid& grid = odds.depth.grid;
  for (int i = 0; i < grid.cells(); ++i) {
    const int x0 = i % grid.columns * grid.cell_px, y0 = i / grid.columns * grid.cell_px;
    const auto block_at = [&](int dx, int dy) {
      return seen.block[static_cast<std::size_t>(y0 + dy) * kWidth_px + x0 + dx];
    };
    const int block = block_at(0, 0), last = grid.cell_px - 1;
    if (block < 0 || odds.depth.z_m[static_cast<std::size_t>(i)] <= 0) continue;
    if (block != block_at(last, 0) || block != block_at(0, last) || block != block_at(last, last)) {
      continue;
    }
    const int moves = odds.moves[static_cast<std::size_t>(i)];
    const bool mover = blocks[static_cast<std::size_t>(block)].moves;
    (mover ? out.mover : out.room) += 1;
    (mover ? out.mover_found : out.room_false) += moves;
  }
  return out;
}

}  // namespace

FoundMotion find_motion(const MoverOptions& mover, const EvidenceOptions& options,
                        std::uint32_t seed) {
  std::mt19937 random(seed);
  const Camera camera = study_camera();
  std::vector<Block> blocks = room(mover);
  const std::vector<Mark> marks = make_marks(blocks, random);
  MotionEvidence evidence(options, camera);
  FoundMotion result;
  double room_cells = 0, false_cells = 0, late_cells = 0, late_found = 0;
  bool alarmed = false;
  for (int i = 0; i < mover.frames; ++i) {
    interruption::throw_if_asked();
    const Vector3d shift_m = {mover.speed_m_s * kFrame_s * std::max(0, i - kStartFrame), 0, 0};
    std::vector<Block> placed = blocks;
    for (Block& block : placed) {
      if (!block.moves) continue;
      block.low += shift_m;
      block.high += shift_m;
    }
    const SE3 T_world_camera = camera_at(i * kFrame_s, mover.camera_speed_m_s, seed);
    const Seen seen = cast_rays(placed, camera, T_world_camera);
    const DepthImage depth_m = sensed(seen, camera, random);
    const auto features = std::make_shared<const Features>(
        features_of(marks, shift_m, placed, seen, depth_m, camera, T_world_camera, random));
    const Timestamp stamp{static_cast<std::int64_t>(1e9 * (1000 + i * kFrame_s))};
    const Counted counted = count_cells(evidence.look(features, depth_m, stamp), seen, placed);
    evidence.settle(std::nullopt, {});
    room_cells += counted.room;
    false_cells += counted.room_false;
    if (counted.room_false >= kAlarmCells && !alarmed) ++result.false_alarms;
    alarmed = counted.room_false >= kAlarmCells;
    const bool found = counted.mover > 0 && 2 * counted.mover_found >= counted.mover;
    if (found && i > kStartFrame && result.frames_to_find < 0) {
      result.frames_to_find = i - kStartFrame;
    }
    if (3 * i < 2 * mover.frames) continue;
    late_cells += counted.mover;
    late_found += counted.mover_found;
  }
  result.found_share = late_cells > 0 ? late_found / late_cells : 0;
  result.false_share = room_cells > 0 ? false_cells / room_cells : 0;
  result.seconds = mover.frames * kFrame_s;
  return result;
}

}  // namespace ydd
