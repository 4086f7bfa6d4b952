// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/live/live_control.h"

/// A published frame as the live page asks for it. Thread: any.
namespace ydd {

/// State and counters: {sequence, frames, serial, frame, stamp_s, state, paused, finished, variant,
/// has_detector, fps, message, resets, keyframes, points, maps, requested, kept, inliers, rejected:
/// {rule: {count, colour}}, boxes, stages_ms: {stage: wall}, recent: lists by name of the last
/// frames: frame, ms, kept, rejected}.
std::string live_state_json(const LiveScene& scene, const LiveFrame& live);

/// The map from above (map_from_above.h), rounded to millimetres: {serial, resets, points,
/// keyframes, path, truth: [x, y, x, y, ...], loops: [[x0, y0, x1, y1]...], camera: [x, y,
/// angle_rad], lost, tracks: [[x, y, vx, vy, id, class]...]}. `path` has null where tracking was
/// interrupted; `truth` is aligned to it, as far as the path goes.
std::string live_map_json(const LiveScene& scene, const LiveFrame& live);

/// The trajectory so far in the map that the camera is in, TUM format.
std::string live_trajectory_tum(const LiveFrame& live);

/// The points of all maps, PLY (binary, little-endian floats, metres).
std::string live_map_ply(const LiveFrame& live);

}  // namespace ydd
