// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/base/options.h"

namespace ydd {

/// How people and moving things are followed in the map's frame.
struct WorldTrackOptions {
  int confirm = 3;              ///< sightings until a track is told
  double coast_s = 1.0;         ///< that a track goes on without a sighting
  double speed_change_m_s = 1;  ///< standard deviation of what a second changes of its speed
  double shape_share = 0.2;     ///< of its extent: how far its middle is misjudged, 1 sigma
  double gate_chi2 = 16.3;      ///< 3 degrees of freedom: farther sightings are of something else
  int thing_cells = 20;         ///< least moving cells, of no detected object, that are a thing
  void describe(OptionTable& table);
};

}  // namespace ydd
