// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/features/orb_extractor.h"
#include "ydd/loop/loop_closer.h"
#include "ydd/mapping/mapper.h"
#include "ydd/reckoning/reckoning_options.h"
#include "ydd/system/detector_runner.h"
#include "ydd/tracking/tracker.h"
#include "ydd/tracks/track_options.h"

namespace ydd {

/// What is kept of the map besides what tracking needs, and when it is saved.
struct MapOptions {
  bool pictures = true;
  bool behind_people = false;  ///< in pictures: what lies in the box of a person, but farther away
  double autosave_s = 5.0;
  int near_keyframes = 1000;
  void describe(OptionTable& table);
};

/// Every setting of the system: one file, one table, saved with each run.
struct SystemOptions {
  OrbOptions orb;
  DynamicsOptions dynamics;
  TrackerOptions tracking;
  ReckoningOptions reckoning;
  MapperOptions mapping;
  LoopOptions loop;
  DetectOptions detect;
  MapOptions map;
  WorldTrackOptions tracks;
  /// Readings up to here tell of their point's place by themselves: they become points at once.
  double close_depth_m = 3.0;
  /// Time of the recording by which mapping may be behind where frames wait for it.
  double mapping_lag_s = 0.2;
  /// What was seen so long ago belongs to an earlier visit of a place.
  double revisit_s = 60.0;
  bool deterministic = false;

  void describe(OptionTable& table);
  /// What is meant: each part with what it shares with the others.
  SystemOptions resolved() const;
};

/// The defaults with `assignments` ("key=value", as for --set) on top.
Result<SystemOptions> system_options(const std::vector<std::string>& assignments);

}  // namespace ydd
