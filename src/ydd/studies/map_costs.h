// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
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
  double apply_ms = 0;    ///< of its correction, with fusing

  double save_whole_ms = 0, save_new_ms = 0;  ///< all of it; what new keyframes changed
  double save_whole_wall_ms = 0, save_new_wall_ms = 0;
  std::int64_t save_whole_bytes = 0, save_new_bytes = 0;  ///< given to the system to be written
  std::int64_t save_new_rows = 0;
  int new_keyframes = 0;  ///< between the two saves

  double load_ms = 0;
};

/// Measures a building and uses it up: place queries, local maps, tracking, insertion of keyframes,
/// a loop, saves to `file` (which is left there) and a load. Failure: the file cannot be written or
/// read.
Result<MapCosts> measure_map(Building building, const SystemOptions& options,
                             const std::filesystem::path& file);

/// The power of the size that a cost grows with: the slope of a line through the logarithms, least
/// squares. NaN with fewer than two different positive pairs.
double fitted_exponent(const std::vector<double>& sizes, const std::vector<double>& costs);

}  // namespace ydd
