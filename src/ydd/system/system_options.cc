// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/system_options.h"

namespace ydd {

void MapOptions::describe(OptionTable& t) {
  t.add("pictures", pictures,
        "keyframes keep a small picture without what moves, for dense clouds: 20 to 60 kB each");
  t.add("autosave", autosave_s, {0.0, 86400.0}, "s",
        "time between saves to the file that --save-map names; 0: at the end only");
}

void SystemOptions::describe(OptionTable& t) {
  t.group("orb", orb);
  t.group("dynamics", dynamics);
  t.group("tracking", tracking);
  t.group("mapping", mapping);
  t.group("loop", loop);
  t.group("detect", detect);
  t.group("map", map);
  t.add("deterministic", deterministic, "map in the tracking thread: two runs give equal bytes");
}

}  // namespace ydd
