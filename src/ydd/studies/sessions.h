// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "ydd/simulation/simulator.h"
#include "ydd/system/system_options.h"

namespace ydd {

/// One run of a row of runs that go on with one map: a visit, or an hour of a long day.
struct Session {
  WorldOptions world;  ///< `frames` is its length; all sessions have the same camera
  CameraPath path;     ///< of this session, from its first frame on
};

/// The n-th session, from 0 on. Pure: it is asked again for where old keyframes really stand.
using SessionPlan = std::function<Session(int number)>;

/// What became of a session.
struct SessionFigures {
  int number = 0;
  std::string light;  ///< as the world's option
  int frames = 0;
  int frames_until_found = 0;  ///< until the first pose; all of them if there was none
  double found_cpu_ms = 0;     ///< the tracking thread's, of the frame with the first pose
  int lost_frames = 0;         ///< after that
  int losses = 0, recoveries = 0;
  double frame_cpu_ms_median = 0, frame_cpu_ms_p95 = 0;
  int keyframes_made = 0, keyframes_culled = 0;
  std::size_t keyframes = 0, points = 0, observations = 0, maps = 0;  ///< of the map afterwards
  std::uintmax_t file_bytes = 0;                                      ///< of the map
  double load_ms = 0, save_ms = 0;                                    ///< processor time
  double ate_m = -1;    ///< of the session, aligned by itself; negative: too little was tracked
  double map_m = -1;    ///< keyframes of the largest map against the truth: root mean square
  double place_m = -1;  ///< the session in the world of that alignment: right place, not only shape
  double found_m = -1;  ///< of these the first pose: how exactly the place was recognised
  int misplaced_frames = 0;  ///< poses more than a metre off there: in another room, or nowhere
  int loops = 0, merges = 0, false_loops = 0;
  double memory_mb = 0;  ///< resident, of the process, before the map is saved
};

/// Told after every frame: how many are done, keyframes of the map.
using SessionProgress = std::function<void(int frames, std::size_t keyframes)>;

/// Runs a session on the map in `map_file` (the first one starts it) and saves it there. Stamps of
/// sessions lie a day apart, so that none is taken for another.
/// Failure: the map cannot be loaded or saved.
Result<SessionFigures> run_session(const SessionPlan& plan, int number,
                                   const SystemOptions& options,
                                   const std::filesystem::path& map_file,
                                   const SessionProgress& progress = {});

/// Visits to one room: the first goes once round, later ones for `seconds` from somewhere on the
/// way, held a little differently each time.
struct VisitOptions {
  WorldOptions world;
  double seconds = 8;
  bool light_changes = true;  ///< each visit has a light of its own; else it is steady
};
SessionPlan visits(const VisitOptions& options);

/// Hours of a walk round and round through all rooms of `world`: in each the light changes in
/// another order, chairs stand elsewhere, and people are about.
struct DayOptions {
  WorldOptions world;
  double session_minutes = 60;
  bool light_changes = true;
  double furniture_moves_m = 0.8;  ///< chairs, at most
};
SessionPlan hours(const DayOptions& options);

}  // namespace ydd
