// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/system_options.h"

namespace ydd {

void SystemOptions::describe(OptionTable& t) {
  t.group("orb", orb);
  t.group("dynamics", dynamics);
  t.group("tracking", tracking);
  t.group("mapping", mapping);
  t.group("loop", loop);
  t.group("detect", detect);
  t.add("deterministic", deterministic, "map in the tracking thread: two runs give equal bytes");
}

}  // namespace ydd
