// SPDX-License-Identifier: Apache-2.0
#include "ydd/robot/robot_slam.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "ydd/detection/given_detections.h"
#include "ydd/map/compatible.h"
#include "ydd/map_files/map_file.h"
#include "ydd/optimization/pose_only.h"
#include "ydd/system/track_recorder.h"

namespace ydd {
namespace {

/// The points of the frame that agree with its pose; empty when the atlas has moved on.
std::vector<PoseObservation> observations_of(const FrameReport& report, const Atlas& atlas) {
  std::vector<PoseObservation> out;
  const Features& features = *report.filtered->kept;
  if (report.points.size() != features.size()) return out;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const MapPoint* const point = atlas.find(report.points[i]);
    if (!point) continue;
    const auto octave = static_cast<std::size_t>(features.keypoints[i].octave);
    out.push_back(
        {point->p_world, uvr_px(features, static_cast<int>(i)), atlas.scales().inv_sigma2[octave]});
  }
  return out;
}

/// Of T_map_camera, from the information of a left perturbation of T_camera_world: position and
/// rotation move against it, in the axes of the camera.
Matrix6d covariance_of(const FrameReport& report, const Atlas& atlas, const SE3& T_map_camera) {
  constexpr double kUnknown = 1.0;  // square metres and radians: nothing is known
  constexpr double kChosen = 1e-8;  // the frame that a map begins with has its pose by choice
  constexpr std::size_t kLeast = 6;
  if (const auto& reckoned = report.track.reckoned) {  // by other senses alone
    Matrix6d out = Matrix6d::Zero();
    out.diagonal().head<3>().setConstant(reckoned->sigma_m * reckoned->sigma_m + kChosen);
    out.diagonal().tail<3>().setConstant(reckoned->sigma_rad * reckoned->sigma_rad + kChosen);
    return out;
  }
  const std::vector<PoseObservation> seen = observations_of(report, atlas);
  if (seen.size() < kLeast) {
    const bool begins = report.keyframe && report.track.inliers == 0;
    return (begins ? kChosen : kUnknown) * Matrix6d::Identity();
  }
  const std::vector<std::uint8_t> all(seen.size(), 1);
  const Matrix6d information =
      pose_information(atlas.camera(), report.track.T_world_camera.inverse(), seen, all);
  const Eigen::LDLT<Matrix6d> solver(information + 1e-6 * Matrix6d::Identity());
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = T_map_camera.rotation_matrix();
  const Matrix6d in_camera = solver.solve(Matrix6d::Identity());
  const Matrix6d out = turn * in_camera * turn.transpose();
  return 0.5 * (out + out.transpose());
}

Result<std::optional<Atlas>> open_map(const std::filesystem::path& file, const MapKey& key) {
  if (file.empty()) return std::optional<Atlas>();
  Result<Atlas> atlas = load_map(file, key);
  if (!atlas) return atlas.error();
  return std::optional<Atlas>(*std::move(atlas));
}

/// Whether the setup can go on with the map.
Result<void> check_fits(const Atlas& map, const RobotSetup& setup) {
  if (auto same = check_same_camera(map.camera(), setup.camera); !same) return same;
  const OrbOptions& orb = setup.options.orb;
  return check_same_scales(map.scales(), PyramidScales::make(orb.levels, orb.scale_step));
}

}  // namespace

SE3 axes_of_robots() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {R, Eigen::Vector3d::Zero()};
}

RobotSlam::RobotSlam(RobotSetup setup)
    : setup_(std::make_unique<const RobotSetup>(std::move(setup))),
      newest_(std::make_unique<Published<const RobotMap>>()) {}

Result<RobotSlam> RobotSlam::make(RobotSetup setup, const std::filesystem::path& map_file) {
  Result<std::optional<Atlas>> map = open_map(map_file, setup.map_key);
  if (!map) return map.error();
  return make(std::move(setup), *std::move(map), map_file.string());
}

Result<RobotSlam> RobotSlam::make(RobotSetup setup, std::optional<Atlas> map,
                                  const std::string& map_name) {
  RobotSlam out(std::move(setup));
  Result<std::unique_ptr<SlamSystem>> system = make_system(*out.setup_, std::move(map), map_name);
  if (!system) return system.error();
  out.system_ = *std::move(system);
  if (auto r = out.save_by_itself(); !r) return r.error();
  out.forget();
  return out;
}

Result<void> RobotSlam::save_by_itself() {
  const std::filesystem::path& file = setup_->autosave_file;
  return file.empty() ? Result<void>() : system_->autosave_to(file);
}

Result<std::unique_ptr<SlamSystem>> RobotSlam::make_system(const RobotSetup& setup,
                                                           std::optional<Atlas> map,
                                                           const std::string& map_name) {
  if (map) {
    const Result<void> fits = check_fits(*map, setup);
    if (!fits) return Error{fmt::format("{}: {}", map_name, fits.error().message)};
  }
  std::unique_ptr<Detector> detector;
  if (setup.make_detector) {
    Result<std::unique_ptr<Detector>> made = setup.make_detector();
    if (!made) return made.error();
    detector = *std::move(made);
  }
  auto system = std::make_unique<SlamSystem>(setup.camera, setup.options, setup.catalogue,
                                             std::move(detector), std::move(map));
  system->set_map_key(setup.map_key);
  system->set_patient(setup.patient);
  return system;
}

void RobotSlam::forget() {
  last_stamp_.reset();
  last_pose_stamp_.reset();
  placed_ = false;
  map_ = {};
  T_map_camera_ = T_odom_camera_ = setup_->T_map_world;
  newest_->set(
      std::make_shared<const RobotMap>(RobotMap{system_->atlas(), MapId{}, setup_->T_map_world}));
}

Result<RobotFrame> RobotSlam::push(const RgbdFrame& asked, std::optional<Detections> given) {
  if (last_stamp_ && asked.stamp <= *last_stamp_) {
    return Error{fmt::format("a frame of {} s came after one of {} s; reset to start anew",
                             format_timestamp(asked.stamp), format_timestamp(*last_stamp_))};
  }
  if (given) {
    Result<Detections> fitting =
        given_detections(*std::move(given), setup_->catalogue, asked.grey.width(),
                         asked.grey.height(), "detections of the frame");
    if (!fitting) return fitting.error();
    given = *std::move(fitting);
  }
  RgbdFrame frame = asked;
  frame.index = std::max(asked.index, frames_);
  frames_ = frame.index + 1;
  Result<FrameReport> report = system_->process(frame, std::move(given));
  if (!report) return report.error();
  last_stamp_ = frame.stamp;
  RobotFrame out;
  out.report = *std::move(report);
  place(out);
  const auto atlas = system_->atlas();
  if (out.has_pose) map_ = atlas->map_of(out.report.track.reference);
  out.covariance = covariance_of(out.report, *atlas, out.T_map_camera);
  for (const WorldTrack& track : out.report.tracks) {
    out.tracks.push_back(moved(track, setup_->T_map_world));
  }
  newest_->set(std::make_shared<const RobotMap>(RobotMap{atlas, map_, setup_->T_map_world}));
  return out;
}

/// Odometry goes on by the motion from frame to frame; where that is not known it stands still, and
/// what the camera did meanwhile is a correction of the map.
void RobotSlam::place(RobotFrame& frame) {
  const TrackResult& track = frame.report.track;
  frame.has_pose = track.reference.valid();
  if (frame.has_pose) {
    T_map_camera_ = setup_->T_map_world * track.T_world_camera;
    if (!placed_) T_odom_camera_ = T_map_camera_;
    placed_ = true;
  }
  if (frame.has_pose && track.T_camera_last && last_pose_stamp_) {
    const SE3 T_last_now = track.T_camera_last->inverse();
    T_odom_camera_ = T_odom_camera_ * T_last_now;
    const double dt_s = seconds_between(*last_pose_stamp_, frame.report.stamp);
    if (dt_s > 0) frame.velocity = T_last_now.log() / dt_s;
  }
  if (frame.has_pose) last_pose_stamp_ = frame.report.stamp;
  frame.T_map_camera = T_map_camera_;
  frame.T_odom_camera = T_odom_camera_;
  frame.T_map_odom = T_map_camera_ * T_odom_camera_.inverse();
}

void RobotSlam::reset() {
  system_->reset();
  forget();
}

Result<void> RobotSlam::load_map(const std::filesystem::path& file) {
  Result<std::optional<Atlas>> map = open_map(file, setup_->map_key);
  if (!map) return map.error();
  return set_map(*std::move(map), file.string());
}

Result<void> RobotSlam::set_map(std::optional<Atlas> map, const std::string& map_name) {
  const bool localize = localization_only();
  Result<std::unique_ptr<SlamSystem>> system = make_system(*setup_, std::move(map), map_name);
  if (!system) return system.error();
  (void)system_->finish(Ending::prompt);  // its map goes
  system_.reset();                        // it holds the file that maps are saved to
  system_ = *std::move(system);
  system_->set_localization_only(localize);
  forget();
  return save_by_itself();
}

StampedPoses RobotSlam::path() const {
  StampedPoses poses = system_->trajectory();
  for (StampedPose& pose : poses) pose.T_world_camera = setup_->T_map_world * pose.T_world_camera;
  return poses;
}

std::vector<Eigen::Vector3f> points_of(const RobotMap& map) {
  std::vector<Eigen::Vector3f> out;
  map.atlas->points().for_each([&](MapPointId, const MapPoint& point) {
    if (map.atlas->map_of(point.observations.front().keyframe) != map.map) return;
    out.push_back((map.T_map_world * point.p_world).cast<float>());
  });
  return out;
}

Result<std::vector<CloudPoint>> cloud_of(const RobotMap& map, const DenseCloudOptions& options) {
  Result<std::vector<CloudPoint>> cloud = dense_cloud(*map.atlas, map.map, options);
  if (!cloud) return cloud;
  for (CloudPoint& point : *cloud) {
    point.p_world = (map.T_map_world * point.p_world.cast<double>()).cast<float>();
  }
  return cloud;
}

Result<OccupancyGrid> grid_of(const RobotMap& map, const GridOptions& options, bool find_floor) {
  SE3 T_grid_world = map.T_map_world;
  if (find_floor) {
    const Result<FloorPlane> floor = floor_of_map(*map.atlas, map.map, options.cloud);
    if (!floor) return floor.error();
    T_grid_world = level_frame(*floor);
  }
  return occupancy_grid(*map.atlas, map.map, T_grid_world, options);
}

}  // namespace ydd
