// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "map/map_jobs.h"

#ifdef YDD_HAS_OCTOMAP
#include <fstream>
#include <sstream>

#include <octomap/OcTree.h>

#include "ydd/base/files.h"
#endif

namespace ydd::app {

#ifdef YDD_HAS_OCTOMAP

Result<void> export_octomap(const Atlas& atlas, MapId map, const MapExportRequest& request) {
  octomap::OcTree tree(request.octomap_resolution_m);
  const auto insert = [&](const KeyframeCloud& keyframe) {
    octomap::Pointcloud cloud;
    cloud.reserve(keyframe.points.size());
    for (const CloudPoint& p : keyframe.points) {
      cloud.push_back(p.p_world.x(), p.p_world.y(), p.p_world.z());
    }
    const octomap::point3d origin(keyframe.origin.x(), keyframe.origin.y(), keyframe.origin.z());
    // One ray for each cube that is hit; inner nodes once, at the end.
    tree.insertPointCloud(cloud, origin, -1.0, true, true);
  };
  if (auto r = for_each_keyframe_cloud(atlas, map, request.cloud, insert); !r) {
    return Error{fmt::format("{}: {}", request.file, r.error().message)};
  }
  tree.updateInnerOccupancy();
  tree.prune();
  std::ostringstream content;
  if (!tree.writeBinaryConst(content)) return Error{request.octomap + ": cannot be written"};
  return write_file_atomically(request.octomap, content.str());
}

#else

Result<void> export_octomap(const Atlas&, MapId, const MapExportRequest&) {
  return Error{
      "--octomap: this program was built without OctoMap; install liboctomap-dev and build it "
      "again"};
}

#endif

}  // namespace ydd::app
