// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ydd/cloud/dense_cloud.h"
#include "ydd/cloud/floor_plane.h"

namespace ydd {

/// How a map becomes a grid of the floor.
struct GridOptions {
  double resolution_m = 0.05;  ///< edge of a cell
  double min_height_m = 0.15;  ///< above the floor: what is lower can be driven over
  double max_height_m = 1.8;   ///< what is higher can be driven under
  double closed_gap_m = 0.10;  ///< between obstacles, that is none: nobody fits through
  DenseCloudOptions cloud;     ///< how readings are gathered before they fall into cells
};

/// What is known of a cell.
enum class Cell : std::int8_t { unknown = -1, vacant = 0, occupied = 100 };  ///< as in ROS

/// Where a robot can go: the floor in cells, seen from above.
struct OccupancyGrid {
  double resolution_m = 0.05;                          ///< edge of a cell, metres
  int columns = 0, rows = 0;                           ///< along x and along y of the grid's frame
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< lower corner of cell (0, 0), grid frame
  std::vector<Cell> cells;                             ///< row by row, by rising y
  SE3 T_grid_world;  ///< the grid's frame (z up, the floor at 0) from the map's world

  /// Unchecked.
  Cell at(int column, int row) const {
    return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(column)];
  }
  bool empty() const { return cells.empty(); }  ///< whether it has no cell at all
};

/// The floor below the static cloud of a map (find_floor).
Result<FloorPlane> floor_of_map(const Atlas& atlas, MapId map, const DenseCloudOptions& options);

/// The grid of what one map's keyframes saw and what did not move (for_each_keyframe_cloud).
/// `T_grid_world`: z up, 0 on the floor, as level_frame has it.
///
/// Each ray from a keyframe to what it saw makes the space in between less likely to be taken, its
/// end more likely, in slices of height (Hornung et al., "OctoMap", 2013, section 3.2). A cell is
/// occupied when a slice within the limits is; free when its floor was seen or its lower
/// slices were looked through; else unknown. Cut to what is known.
/// Failure: a picture that cannot be opened, or more than 64 million cells.
Result<OccupancyGrid> occupancy_grid(const Atlas& atlas, MapId map, const SE3& T_grid_world,
                                     const GridOptions& options);

/// As `map_server` of ROS reads it: PGM, 254 free, 0 occupied, 205 unknown, the first row is the
/// one with the largest y.
std::string format_pgm(const OccupancyGrid& grid);
/// The YAML beside it; `image` is the name of the PGM as the YAML should tell it.
std::string format_map_yaml(const OccupancyGrid& grid, const std::string& image);

}  // namespace ydd
