// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/world_options.h"

namespace ydd {

void WorldOptions::describe(OptionTable& t) {
  t.add("seed", seed, {0, 1e9}, "", "everything random follows from it");
  t.add("width", width_px, {64, 1920}, "px", "image width");
  t.add("height", height_px, {48, 1440}, "px", "image height");
  t.add("fps", fps, {1.0, 200.0}, "Hz", "frame rate");
  t.add("frames", frames, {0, 1e6}, "", "length; 0: one round of the path");
  t.add("path", path, "how the camera moves");
  t.add("people", people, {0, 12}, "", "people in the first room");
  t.add("busy", busy, "people 0.9 to 2 m away before a plainer wall; three unless 'people' is set");
  t.add("mover", mover, "one large thing of no known class that moves, a third of the view");
  t.add("sit_then_leave", sit_then_leave,
        "one more person who stands close by for 3 s, then walks out of view for good");
  t.add("come_and_stay", come_and_stay,
        "one more person who walks in within 2 s, then stands close by to the end");
  t.add(
      "chairs_moved_m", chairs_moved_m, {-2.0, 2.0}, "m",
      "the chairs before the north wall stand so far to the right of their places: another visit");
  t.add("frozen_at_s", frozen_at_s, {-1.0, 1e6}, "s",
        "all that moves stands still as it is at that time; -1: it moves");
  t.add("rooms", rooms, {1, 20}, "", "rooms in a row, joined by doors");
  t.add("repeated_posters", repeated_posters, "every wall carries the same posters");
  t.add("identical_desks", identical_desks, "all desks carry the same things");
  t.add("wall_detail", wall_detail, {0.0, 1.0}, "", "share of the places for posters in use");
  t.add("texture_detail", texture_detail, {0.05, 4.0}, "",
        "texture resolution; 1 suits the camera");
  t.add("depth", depth, "depth sensor model");
  t.add("registration_off_px", registration_off_px, {0.0, 20.0}, "px",
        "depth lies that far to the right of colour; at 640 px width, scaled with it");
  t.add("depth_late_ms", depth_late_ms, {0.0, 100.0}, "ms",
        "depth shows the world as it was that long before colour");
  t.add("pixel_noise", pixel_noise, {0.0, 50.0}, "", "standard deviation of a pixel, grey levels");
  t.add("exposure_noise", exposure_noise, {0.0, 0.5}, "", "standard deviation of a frame's gain");
  t.add("light", light,
        "what shines; any but steady also has the camera's automatic exposure and white balance");
  t.add("light_seed", light_seed, {0, 1e9}, "", "which day or evening it is");
  t.add("light_change_s", light_change_s, {0.1, 1e5}, "s",
        "each light of 'changing' lasts so long");
  t.add("covered_from", covered_from, {0, 1e6}, "", "first frame with a covered (black) lens");
  t.add("covered_frames", covered_frames, {0, 1e6}, "", "number of frames with a covered lens");
  t.group("sensors", sensors);
  t.add("edge_samples", edge_samples, {1, 16}, "", "extra samples of pixels on edges");
  t.add("threads", threads, {0, 256}, "",
        "of the renderer; 0: all cores; no influence on pictures");
}

Camera simulated_camera(const WorldOptions& options) {
  const double scale_x = options.width_px / 640.0;
  const double scale_y = options.height_px / 480.0;
  Camera camera;
  camera.name = "simulated";
  camera.width_px = options.width_px;
  camera.height_px = options.height_px;
  camera.fx_px = 535.4 * scale_x;
  camera.fy_px = 539.2 * scale_y;
  camera.cx_px = (320.1 + 0.5) * scale_x - 0.5;  // pixel centres are at integers
  camera.cy_px = (247.6 + 0.5) * scale_y - 0.5;
  camera.fps = options.fps;
  if (options.depth == DepthModel::kinect) {
    camera.min_depth_m = 0.5;
    camera.max_depth_m = 4.5;
  }
  return camera;
}

}  // namespace ydd
