// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ydd/live/live_control.h"

namespace ydd {

/// A corner of what is drawn: world frame, metres; red, green, blue, alpha.
struct SceneVertex {
  std::array<float, 3> p_world{};
  std::array<std::uint8_t, 4> rgba{};
};
/// Points, or lines from each even vertex to the next one.
using Vertices = std::vector<SceneVertex>;
using Rgba = std::array<std::uint8_t, 4>;

/// Colours of the map on a dark ground. As in pictures and reports the estimate is blue, its error
/// red, a point that is seen now green; truth, black on paper, is white here.
namespace scene_colour {
inline constexpr Rgba kPoint{150, 162, 186, 255};
inline constexpr Rgba kSeenPoint{60, 255, 90, 255};
inline constexpr Rgba kKeyframe{96, 140, 255, 200};
inline constexpr Rgba kCovisibility{70, 130, 150, 70};
inline constexpr Rgba kLoop{255, 170, 40, 255};
inline constexpr Rgba kTrajectory{80, 160, 255, 255};
inline constexpr Rgba kTruth{245, 245, 245, 130};
inline constexpr Rgba kError{255, 70, 70, 200};
inline constexpr Rgba kTracking{60, 255, 90, 255};
inline constexpr Rgba kLost{255, 70, 70, 255};
inline constexpr Rgba kGrid{255, 255, 255, 22};
inline constexpr Rgba kTrack{213, 139, 224, 255};
}  // namespace scene_colour

/// What the map looks like: of the map that tracking is in; other maps have worlds of their own.
/// Changes when the atlas changes or a frame is added.
struct MapScene {
  Vertices points;                                    ///< points
  Vertices keyframes, covisibility, loops;            ///< lines
  Vertices trajectory, truth, errors, grid;           ///< lines
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of most points and all keyframes
  double radius_m = 1;                                ///< of a ball that holds them
  Eigen::Vector3d up{0, -1, 0};                       ///< see world_up
  std::optional<double> error_rmse_m;                 ///< of the trajectory so far, aligned
  int keyframe_count = 0, point_count = 0, maps = 0;  ///< `maps`: of the whole atlas
};
MapScene build_map_scene(const LiveFrame& live, const StampedPoses& groundtruth);

/// A name and the place in the world where it belongs.
struct SceneLabel {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  std::string text;
  Rgba colour{};
};

/// What belongs to the newest frame alone.
struct CurrentScene {
  Vertices seen_points;               ///< points: map points found in it
  Vertices camera;                    ///< lines: its pyramid, red while lost
  std::optional<SE3> T_world_camera;  ///< where it was last known to be
  Vertices tracks;  ///< lines: a box round each person and moving thing, upright, and an arrow to
                    ///< where it will be in a second; paler while it is not seen
  std::vector<SceneLabel> labels;  ///< class and number above each box
};
/// `up` as MapScene has it.
CurrentScene build_current_scene(const LiveFrame& live, const Camera& camera,
                                 const Eigen::Vector3d& up = {0, -1, 0});

/// The map that tracking is in, or was in last. Empty while there is none.
MapId current_map(const LiveFrame& live);

}  // namespace ydd
