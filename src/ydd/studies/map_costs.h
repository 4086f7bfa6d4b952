// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/studies/building.h"
#include "ydd/system/system_options.h"

namespace ydd {

/// What a map of one size costs. Times are milliseconds of processor time of the one thread that
/// works, except where the name says wall.
struct MapCosts {
  std::size_t keyframes = 0, points = 0;

  std::vector<double> query_ms;       ///< place of a keyframe of the second session in the first
  int recognised = 0;                 ///< of these: the best candidate is the same place
  std::vector<double> gather_ms;      ///< local map around the points of a keyframe
  std::vector<double> relocalise_ms;  ///< a lost camera, until it is found or given up
  std::vector<double> track_ms;       ///< a frame while tracking
  int lost_frames = 0;                ///< of those that should have been tracked
  std::vector<double> insert_ms;      ///< Mapper::process
  std::vector<double> publish_ms;     ///< a snapshot, and letting go of the last one
  std::vector<double> look_ms;        ///< for a loop of a keyframe that closes none

  double correct_ms = 0;  ///< pose graph of a loop through the whole first session
  double prepare_ms = 0;  ///< moving a copy of the map, beside the mapper
  double apply_ms = 0;    ///< of its correction, with fusing, as the mapper does

  double save_whole_ms = 0, save_new_ms = 0;  ///< all of it; what new keyframes changed
  double save_whole_wall_ms = 0, save_new_wall_ms = 0;
  std::int64_t save_whole_bytes = 0, save_new_bytes = 0;  ///< given to the system to be written
  std::int64_t save_new_rows = 0;
  int new_keyframes = 0;  ///< between the two saves

  double load_ms = 0;

  // Localised in with only what is near in memory.
  double open_ms = 0;            ///< until the first frame may come
  double opened_mb = 0;          ///< memory then, and ...
  double walked_mb = 0;          ///< ... after the walks of relocalise_ms and track_ms
  std::vector<double> place_ms;  ///< a lost camera: query, and loading what it leads to
  std::vector<double> near_ms;   ///< a frame that loaded what it neared
  int lost_in_part = 0;          ///< frames that should have been tracked
};

/// Memory that the process holds now, megabytes; memory that is free has been given back before.
using ResidentMemory = std::function<double()>;

/// Measures a building and uses it up: place queries, local maps, tracking, insertion of keyframes,
/// a loop, saves to `file` (which is left there) and a load. Failure: the file cannot be written or
/// read.
Result<MapCosts> measure_map(Building building, const SystemOptions& options,
                             const std::filesystem::path& file, const ResidentMemory& resident_mb);

/// The power of the size that a cost grows with: the slope of a line through the logarithms, least
/// squares. NaN with fewer than two different positive pairs.
double fitted_exponent(const std::vector<double>& sizes, const std::vector<double>& costs);

}  // namespace ydd
