// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "ydd/evidence/evidence_options.h"

namespace ydd {

/// A room of planes and boxes with marked points, past which the camera is carried by hand, and a
/// box in it that stands for half a second and then moves sideways. Depth has the noise of a
/// structured-light sensor, points half a pixel. Nothing is rendered and nothing is detected: what
/// is studied is the evidence alone, with its own idea of the camera's motion.
struct MoverOptions {
  double side_m = 0.5;      ///< of the box that moves; 0: nothing does
  double distance_m = 1.8;  ///< from the first camera
  double speed_m_s = 0.5;
  double camera_speed_m_s = 0.2;  ///< largest
  int frames = 60;                ///< at 30 Hz
};

/// How well motion was found.
struct FoundMotion {
  int frames_to_find = -1;  ///< from when it started until half of its cells are judged to move
  double found_share = 0;   ///< of its cells, in the last third of the sequence
  double false_share = 0;   ///< of the cells of the room that were judged to move, all frames
  int false_alarms = 0;     ///< times that a surface of the room began to move: 20 cells at once
  double seconds = 0;       ///< of the sequence
};

/// Everything follows from `seed`.
FoundMotion find_motion(const MoverOptions& mover, const EvidenceOptions& options,
                        std::uint32_t seed);

}  // namespace ydd
