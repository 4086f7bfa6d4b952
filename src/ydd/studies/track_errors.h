// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ydd/studies/simulated_run.h"

namespace ydd {

/// People of a simulated world as they were tracked, held against where they were. Pairs as in
/// K. Bernardin, R. Stiefelhagen, "Evaluating multiple object tracking performance: the CLEAR MOT
/// metrics", 2008: one that was right and still is within `kPair_m` stays, the rest by distance.
struct TrackErrors {
  int wanted = 0;      ///< people in frames in which they were to be seen
  int found = 0;       ///< of these
  int told = 0;        ///< tracks of people in frames
  int false_ones = 0;  ///< of these, where nobody was
  int switches = 0;    ///< a person's track became another one
  int within = 0;      ///< of the pairs, inside two standard deviations (95 % on the floor: 2.45)
  std::vector<double> across_m;      ///< of each pair, along the floor
  std::vector<double> height_m;      ///< up and down
  std::vector<double> velocity_m_s;  ///< along the floor, once a track is a second old
  void add(const TrackErrors& other);
};

/// How far a track may be from its person, along the floor.
inline constexpr double kPair_m = 0.5;

/// `run` is one over `simulator`. A person is to be seen where it fills half a percent of the
/// picture. The map's world is placed by the first tracked frame.
TrackErrors track_errors(const SimulatedRun& run, const Simulator& simulator);

}  // namespace ydd
