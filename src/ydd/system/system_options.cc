// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/system_options.h"

namespace ydd {

void MapOptions::describe(OptionTable& t) {
  t.add("pictures", pictures,
        "keyframes keep a small picture without what moves, for dense clouds: 20 to 60 kB each");
  t.add("behind_people", behind_people,
        "these pictures keep what is seen in the box of a person but lies behind; denser clouds, "
        "and some pixels of people");
  t.add("autosave_s", autosave_s, {0.0, 86400.0}, "s",
        "time between saves to the file that --save-map names; 0: at the end only");
  t.add(
      "near_keyframes", near_keyframes, {0, 1'000'000}, "",
      "with --localization-only, of a larger map only about so many keyframes near the camera are "
      "in memory; 0: all of it");
}

void SystemOptions::describe(OptionTable& t) {
  t.group("orb", orb);
  t.group("dynamics", dynamics);
  t.group("tracking", tracking);
  t.group("reckoning", reckoning);
  t.group("mapping", mapping);
  t.group("loop", loop);
  t.group("detect", detect);
  t.group("map", map);
  t.group("tracks", tracks);
  t.add("close_depth_m", close_depth_m, {0.1, 100.0}, "m",
        "nearer readings become points at once and count when keyframes are compared");
  t.add(
      "mapping_lag_s", mapping_lag_s, {0.0, 60.0}, "s",
      "recordings that are played flat out wait for a mapper that is further behind, in their own "
      "time; at a camera's pace (--realtime, cameras, ROS) nothing waits");
  t.add("revisit_s", revisit_s, {1.0, 1e9}, "s",
        "keyframes so much older are of an earlier visit: the place is known, and few are added");
  t.add("deterministic", deterministic, "map in the tracking thread: two runs give equal bytes");
}

SystemOptions SystemOptions::resolved() const {
  constexpr int kDeterministicLatency_frames = 2;  // equal results need answers at fixed frames
  SystemOptions result = *this;
  result.tracking.close_depth_m = close_depth_m;
  result.mapping.close_depth_m = close_depth_m;
  result.mapping.inertial.T_camera_imu = reckoning.T_camera_imu;
  result.mapping.cull.close_depth_m = close_depth_m;
  result.mapping.cull.revisit_s = revisit_s;
  result.tracking.keyframe.revisit_s = revisit_s;
  result.loop.limits = tracking.match;  // matches and poses by the same rules as tracking
  result.loop.pose = tracking.pose;
  if (deterministic && detect.latency_frames == 0) {
    result.detect.latency_frames = kDeterministicLatency_frames;
  }
  return result;
}

Result<SystemOptions> system_options(const std::vector<std::string>& assignments) {
  SystemOptions options;
  OptionTable table;
  options.describe(table);
  for (const std::string& assignment : assignments) {
    if (auto r = table.set_assignment(assignment, "--set"); !r) return r.error();
  }
  return options;
}

}  // namespace ydd
