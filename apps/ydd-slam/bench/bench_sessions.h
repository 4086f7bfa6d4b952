// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/figures.h"

namespace ydd::app {

/// What the benches of many runs on one map have in common.
struct SessionRequest {
  int sessions = 100;  ///< visits, or hours
  int seed = 101;      ///< vocabulary's training pictures are below 100
  int width_px = 320;  ///< 4:3
  double fps = 5;
  double seconds = 8;   ///< of a visit
  double minutes = 60;  ///< of an "hour"
  int rooms = 20;       ///< of the building
  int people = 2;       ///< in its first room
  bool steady = false;  ///< light that does not change
  std::string folder;   ///< map and figures so far: a second call goes on there; empty: a scratch
  bool quiet = false;   ///< no progress
  std::string out;      ///< JSON file; empty: none
  std::vector<std::string> set;
};

/// One room visited again and again in changing light: keyframes, points, file, how soon it is
/// recognised and how exactly, by visit.
Result<std::string> bench_visits(const SessionRequest& request);

/// Hours through a building with changing light, people and furniture that moves, one map.
Result<std::string> bench_days(const SessionRequest& request);

}  // namespace ydd::app
