// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <stop_token>
#include <utility>
#include <vector>

#include "ydd/base/timing.h"
#include "ydd/map/atlas.h"
#include "ydd/map/correction.h"
#include "ydd/mapping/cull.h"
#include "ydd/mapping/inertial_window.h"
#include "ydd/mapping/local_bundle.h"
#include "ydd/mapping/triangulate.h"
#include "ydd/matching/keyframe_candidate.h"

namespace ydd {

/// The settings of each step of mapping.
struct MapperOptions {
  LocalBundleOptions bundle;
  InertialOptions inertial;
  CullOptions cull;
  TriangulationOptions triangulation;
  MatchLimits match;
  int min_covisible_weight = 15;
  int min_depth_points = 10000;
  double close_depth_m = 3.0;  ///< SystemOptions sets it
  int fuse_neighbours = 10;
  double fuse_radius_px = 3.0;
  void describe(OptionTable& table);
};

/// What one keyframe did to the map.
struct MapperReport {
  KeyFrameId keyframe;          ///< in the map that it was inserted into
  int points_from_depth = 0;    ///< points created of depth readings
  int points_triangulated = 0;  ///< points created from two keyframes' views
  int points_fused = 0;         ///< points that turned out to be others
  int points_culled = 0;        ///< recent points that were not seen again
  int keyframes_culled = 0;     ///< keyframes whose points enough others see
  StageTimes times;             ///< of its steps, in order
};

/// What became of a correction whose map may have moved on since it was computed.
enum class Applied {
  as_computed,  ///< nothing had changed
  rebased,      ///< carried over to what is newer than its snapshot
  refused,      ///< another correction came first: it would be undone. The map is as it was.
};

/// Builds and refines the map, one candidate at a time; owner of the atlas.
///
/// insert -> cull points -> create points -> fuse -> bundle adjustment -> cull keyframes. Each step
/// gathers, solves and applies in functions of its own.
/// Thread: one. Deterministic as long as no stop is requested.
class Mapper {
 public:
  /// Starts with an empty map.
  Mapper(const Camera& camera, const PyramidScales& scales, const MapperOptions& options);
  /// Goes on with a map that was made before.
  Mapper(Atlas atlas, const MapperOptions& options);

  /// Takes a candidate into the map. `stop` interrupts bundle adjustment (the map stays valid).
  MapperReport process(const KeyFrameCandidate& candidate, std::stop_token stop = {});

  /// Takes over a correction that was computed on an earlier snapshot, if that still makes sense.
  [[nodiscard]] Applied apply(const Correction& correction);

  /// The map as it is, immutable.
  std::shared_ptr<const Atlas> snapshot() { return atlas_.snapshot(); }
  /// The map as it is, until the next call changes it.
  const Atlas& atlas() const { return atlas_; }
  /// The map itself, when nothing more is to be mapped.
  Atlas take_atlas() && { return std::move(atlas_); }

 private:
  std::set<MapId> maps_of(const Correction& correction) const;
  KeyFrameId insert(const KeyFrameCandidate& candidate);
  int add_points_from_depth(KeyFrameId keyframe);

  MapperOptions options_;
  Atlas atlas_;
  InertialWindow inertial_;
  std::vector<MapPointId> recent_points_;  ///< created lately, on probation
  /// The revision at which a map was last moved as a whole.
  std::map<MapId, std::uint64_t> corrected_;
};

}  // namespace ydd
