// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracks/track_options.h"

namespace ydd {

void WorldTrackOptions::describe(OptionTable& t) {
  t.add("confirm", confirm, {1, 100}, "sightings", "a person or thing is told of after so many");
  t.add("coast_s", coast_s, {0.0, 60.0}, "s", "a track goes on for so long without a sighting");
  t.add("speed_change_m_s", speed_change_m_s, {0.01, 20.0}, "m/s",
        "standard deviation of what a second changes of a velocity");
  t.add("shape_share", shape_share, {0.0, 1.0}, "",
        "how far the middle of a thing is misjudged, as share of its extent");
  t.add("gate_chi2", gate_chi2, {1.0, 1000.0}, "",
        "largest chi-square of a sighting's distance from its track");
  t.add("thing_cells", thing_cells, {1, 100000}, "cells",
        "least moving surface that is a thing of its own (variant evidence)");
}

}  // namespace ydd
