// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ydd/base/published.h"
#include "ydd/cloud/occupancy_grid.h"
#include "ydd/system/slam_system.h"

/// The system as a robot uses it: frames go in one by one, and what comes back is in the robot's
/// frames (REP 105): map, odom, camera. Knows no middleware: a node of ROS 1, or of anything else,
/// turns these values into its messages.
namespace ydd {

/// The map's frame as robots have it (x ahead, y to the left, z up) from the world (the first
/// camera: x right, y down, z ahead), for a camera that looked straight ahead.
SE3 axes_of_robots();

/// What a system is made of.
struct RobotSetup {
  Camera camera;              ///< colour, with depth registered to it
  SystemOptions options;      ///< as SlamSystem takes them
  ObjectCatalogue catalogue;  ///< what the detector's classes mean
  /// Called for each new system; gives null for none.
  std::function<Result<std::unique_ptr<Detector>>()> make_detector;
  SE3 T_map_world = axes_of_robots();   ///< world: the first camera
  std::filesystem::path autosave_file;  ///< SlamSystem::autosave_to; empty: none
  MapKey map_key;                       ///< of every map that is loaded or saved; empty: plain ones
  bool patient = false;                 ///< for recordings: as SlamSystem::set_patient
};

/// What became of one frame.
struct RobotFrame {
  FrameReport report;     ///< its tracks are in the world frame
  bool has_pose = false;  ///< else the poses are the last ones that were known
  SE3 T_map_camera;       ///< where the camera is, as the map is believed to be now
  SE3 T_odom_camera;      ///< goes on smoothly: corrections of the map are in T_map_odom
  SE3 T_map_odom;  ///< what the map corrects of the odometry: T_map_camera * T_odom_camera^-1
  /// Of T_map_camera: position, then rotation about the map's axes; square metres and radians. What
  /// the matches of this frame leave open: how far the map itself has drifted is not in it.
  Matrix6d covariance = Matrix6d::Identity();
  Vector6d velocity = Vector6d::Zero();  ///< m/s, then rad/s, in the camera frame
  std::vector<WorldTrack> tracks;        ///< in the map frame
};

/// A map as it was at some time, for whoever works on it elsewhere meanwhile.
struct RobotMap {
  std::shared_ptr<const Atlas> atlas;  ///< never null
  MapId map;                           ///< that the camera is in, or was in last
  SE3 T_map_world;                     ///< as RobotSetup has it
};

/// Thread: one, but for `newest_map`.
class RobotSlam {
 public:
  /// Fails when the detector cannot be made or `map_file` (may be empty) cannot be gone on with.
  static Result<RobotSlam> make(RobotSetup setup, const std::filesystem::path& map_file);
  /// The same with a map that is at hand (none: from nothing), by this name in failures.
  static Result<RobotSlam> make(RobotSetup setup, std::optional<Atlas> map,
                                const std::string& map_name);

  /// Frames must come by rising stamps; one that does not is a failure that costs nothing. What
  /// else fails is as SlamSystem::process has it. Its index counts the frames that came; a larger
  /// one of its own, which counts those that a recording left out, is kept.
  /// With `given`, whatever somebody found in the picture (given_detections), nobody else is asked.
  Result<RobotFrame> push(const RgbdFrame& frame, std::optional<Detections> given = {});

  /// Other senses, as SlamSystem::add: before the first frame that is not earlier.
  void add(const ImuSample& sample) { system_->add(sample); }
  void add(const OdometryPose& pose) { system_->add(pose); }  ///< The same.

  /// Forgets map and path; the next frame starts anew.
  void reset();
  /// Goes on in the map of a file instead of the one there is, which stays if that fails.
  Result<void> load_map(const std::filesystem::path& file);
  /// The same with a map that is at hand.
  Result<void> set_map(std::optional<Atlas> map, const std::string& map_name);
  /// As SlamSystem::save_map.
  Result<void> save_map(const std::filesystem::path& file) { return system_->save_map(file); }
  /// As SlamSystem has it; before any frame.
  void set_localization_only(bool on) { system_->set_localization_only(on); }
  /// Whether the map is used without being changed.
  bool localization_only() const { return system_->localization_only(); }
  /// What waits is worked off.
  Result<void> finish(Ending ending) { return system_->finish(ending); }

  /// Poses of all frames in the newest state of the map, map frame.
  StampedPoses path() const;
  /// How many loops were closed since the map was new.
  int loops() const { return static_cast<int>(system_->mapping_reports().loops.size()); }
  const RobotSetup& setup() const { return *setup_; }  ///< As it was given.
  /// For what is asked of it alone, in the world frame.
  const SlamSystem& system() const { return *system_; }
  /// Any thread; null before the first frame.
  std::shared_ptr<const RobotMap> newest_map() const { return newest_->get(); }

 private:
  explicit RobotSlam(RobotSetup setup);
  static Result<std::unique_ptr<SlamSystem>> make_system(const RobotSetup& setup,
                                                         std::optional<Atlas> map,
                                                         const std::string& map_name);
  Result<void> save_by_itself();
  void forget();
  void place(RobotFrame& frame);

  std::unique_ptr<const RobotSetup> setup_;
  std::unique_ptr<SlamSystem> system_;
  std::unique_ptr<Published<const RobotMap>> newest_;
  std::optional<Timestamp> last_stamp_;
  std::optional<Timestamp> last_pose_stamp_;
  std::int64_t frames_ = 0;
  bool placed_ = false;
  MapId map_;
  SE3 T_map_camera_, T_odom_camera_;
};

/// The points by which the camera is tracked, map frame. Any thread.
std::vector<Eigen::Vector3f> points_of(const RobotMap& map);
/// The dense static cloud, map frame. Any thread. Failure: as dense_cloud.
Result<std::vector<CloudPoint>> cloud_of(const RobotMap& map, const DenseCloudOptions& options);
/// The floor as the map's x-y plane has it, or (`find_floor`) where a floor is seen below. Any
/// thread. Failure: as occupancy_grid. The grid's T_grid_world belongs to the world, not to the map
/// frame.
Result<OccupancyGrid> grid_of(const RobotMap& map, const GridOptions& options, bool find_floor);

}  // namespace ydd
