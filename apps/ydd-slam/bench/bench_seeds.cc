// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_seeds.h"

namespace ydd::app {

WorldOptions walk_world(const SeedRequest& request, int seed, int rooms) {
  WorldOptions world;
  world.seed = seed;
  world.rooms = rooms;
  world.path = PathKind::room_loop;
  world.depth = DepthModel::kinect;
  world.width_px = request.width_px;
  world.height_px = request.width_px * 3 / 4;
  world.fps = request.fps;
  world.threads = 0;
  world.edge_samples = 1;  // half the time, and nobody looks at these pictures
  return world;
}

bool is_wanted(const SeedRequest& request, const std::string& name) {
  return name.find(request.only) != std::string::npos;
}

}  // namespace ydd::app
