// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "ydd/studies/simulated_run.h"

namespace ydd {

/// Something that goes wrong on a simulated walk.
struct Accident {
  const char* name;
  double from_s, until_s;  ///< when nothing of the known map can be seen
  double length_s;
  CameraPath (*path)(const CameraPath& walk);
  FrameEdit (*edit)(double fps, double from_s, double until_s);
};

/// Covered, crowded, turned away, kidnapped to a place seen before and to one that was not, and
/// what only other senses help against.
std::span<const Accident> accidents();

/// How one accident ended.
struct AccidentOutcome {
  std::optional<int> frames;  ///< until tracked again at the right place
  bool wrong = false;         ///< a false loop, or at a wrong place in the end
  bool merged = false;        ///< a new map found back to the old one
  double ate_m = 0;
  double with_pose_share = 0;  ///< of the frames
};

/// What goes along with the camera besides.
enum class Senses { none, imu, wheels, both };
constexpr std::array<std::string_view, 4> choices_of(Senses) {
  return {"none", "imu", "wheels", "both"};
}

/// Holds a run against the truth: found again is who tracks within 0.1 m of where it is.
AccidentOutcome outcome_of(const SimulatedRun& run, const Accident& accident, double fps);

/// Walks round the world until the accident has happened and is over.
Result<AccidentOutcome> suffer(const Accident& accident, WorldOptions world, SystemOptions options,
                               Senses senses = Senses::none);

}  // namespace ydd
