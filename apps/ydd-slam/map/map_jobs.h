// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/cloud/dense_cloud.h"
#include "ydd/cloud/occupancy_grid.h"
#include "ydd/map/keep_maps.h"

namespace ydd::app {

struct MapInfoRequest {
  std::string file, map_key;  ///< here as below: file with the key; empty: as MapKey::find
  bool json = false;
};

struct MapExportRequest {
  std::string file, map_key;
  std::string sparse, dense, keyframes, octomap;  ///< files to write; empty: not wanted
  std::string grid;                               ///< .pgm; its YAML is written beside it
  GridOptions grid_options;
  DenseCloudOptions cloud;
  double octomap_resolution_m = 0.05;
  int which = -1;  ///< negative: the map with most keyframes
};

struct MapCheckRequest {
  std::string file, map_key;
};

struct MapPruneRequest {
  std::string file, out, map_key;
  PruneOptions options;
  bool replace_map = false;  ///< at `out`, even by a lesser map
};

struct MapSplitRequest {
  std::string file, out, map_key;
  std::vector<int> which;  ///< numbers of maps
  bool replace_map = false;
};

struct MapMergeRequest {
  std::vector<std::string> files;    ///< at least two; the world of the first stays
  std::string out, config, map_key;  ///< of all of them
  std::vector<std::string> set;
  bool replace_map = false;  ///< at `out`, even by a lesser map
};

struct MapConvertRequest {
  std::string file, out;  ///< empty `out`: `file` is replaced
  std::string map_key;
  std::string old_key;  ///< to encrypt: of what is encrypted already; empty: it is not
};

Result<void> map_info(const MapInfoRequest& request);
Result<void> map_export(const MapExportRequest& request);
Result<void> map_merge(const MapMergeRequest& request);
/// Says whether a file is sound. Failure: it is not; all that is wrong has been told.
Result<void> map_check(const MapCheckRequest& request);
/// Writes a map without what was never seen again.
Result<void> map_prune(const MapPruneRequest& request);
/// Writes some of the maps of a file into another one.
Result<void> map_split(const MapSplitRequest& request);

/// Encrypts a map file, or gives it another key.
Result<void> map_encrypt(const MapConvertRequest& request);
/// Makes it plain.
Result<void> map_decrypt(const MapConvertRequest& request);

/// Occupied and free space of one map into an OctoMap file. Failure also when this program was
/// built without OctoMap.
Result<void> export_octomap(const Atlas& atlas, MapId map, const MapExportRequest& request);

}  // namespace ydd::app
