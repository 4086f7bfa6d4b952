// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/figures.h"

namespace ydd::app {

struct ScaleRequest {
  std::vector<std::size_t> sizes{1000, 3000, 10000};  ///< keyframes
  std::uint64_t seed = 1;
  int first_seed = 101;  ///< of the simulated rooms that the buildings are grown from
  int rooms = 3;         ///< different ones
  int width_px = 320;    ///< 4:3
  double fps = 10;
  int keypoints = 500;  ///< a keyframe, about
  std::string out;      ///< JSON file; empty: none
  std::vector<std::string> set;
};

/// What a map costs by its size: place queries, local maps, tracking, keyframes, a loop, saves, a
/// load, memory; with the exponent that each grows with. Maps are grown from simulated rooms.
Result<std::string> bench_scale(const ScaleRequest& request);

}  // namespace ydd::app
