// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/cloud/dense_cloud.h"
#include "ydd/cloud/occupancy_grid.h"

namespace ydd::app {

struct MapInfoRequest {
  std::string file;
  bool json = false;
};

struct MapExportRequest {
  std::string file;
  std::string sparse, dense, keyframes, octomap;  ///< files to write; empty: not wanted
  std::string grid;                               ///< .pgm; its YAML is written beside it
  GridOptions grid_options;
  DenseCloudOptions cloud;
  double octomap_resolution_m = 0.05;
  int which = -1;  ///< negative: the map with most keyframes
};

struct MapMergeRequest {
  std::string first, second, out, config;
  std::vector<std::string> set;
  bool replace_map = false;  ///< at `out`, even by a lesser map
};

Result<void> map_info(const MapInfoRequest& request);
Result<void> map_export(const MapExportRequest& request);
Result<void> map_merge(const MapMergeRequest& request);

/// Occupied and free space of one map into an OctoMap file. Failure also when this program was
/// built without OctoMap.
Result<void> export_octomap(const Atlas& atlas, MapId map, const MapExportRequest& request);

}  // namespace ydd::app
