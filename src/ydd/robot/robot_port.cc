// SPDX-License-Identifier: Apache-2.0
#include "ydd/robot/robot_port.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/guard.h"
#include "ydd/image/decode.h"
#include "ydd/messages/ros_pictures.h"
#include "ydd/pictures/annotate.h"
#include "ydd/robot/robot_setup.h"
#include "ydd/system/track_recorder.h"

namespace ydd {
namespace {

PortPose port_pose(const SE3& T) {
  const Eigen::Vector3d& t = T.translation();
  const Eigen::Quaterniond& q = T.rotation();
  return {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

/// A quaternion of any length; one that is none turns nothing.
SE3 from_port(const PortPose& pose) {
  const auto& [x, y, z, w] = pose.orientation;
  Eigen::Quaterniond q(w, x, y, z);
  if (!(q.norm() > 1e-6) || !std::isfinite(q.norm())) q = Eigen::Quaterniond::Identity();
  return {q, Eigen::Vector3d(pose.position_m[0], pose.position_m[1], pose.position_m[2])};
}

std::array<double, 3> port_vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::array<double, 36> port_matrix(const Matrix6d& m) {
  std::array<double, 36> out;
  for (int i = 0; i < 36; ++i) out[static_cast<std::size_t>(i)] = m(i / 6, i % 6);
  return out;
}

ImageMessage from_port(const PortImage& image) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max();
  ImageMessage out;
  // What is below 0 is too much as well.
  out.width_px = static_cast<std::uint32_t>(image.width_px);
  out.height_px = static_cast<std::uint32_t>(image.height_px);
  out.step = static_cast<std::uint32_t>(std::min(image.step_bytes, kMost));
  out.encoding = image.encoding;
  out.big_endian = image.big_endian;
  if (image.bytes) out.data = {reinterpret_cast<const char*>(image.bytes), image.size_bytes};
  return out;
}

CompressedImageMessage packed_from_port(const PortImage& image) {
  CompressedImageMessage out;
  out.format = image.encoding;
  if (image.bytes) out.data = {reinterpret_cast<const char*>(image.bytes), image.size_bytes};
  return out;
}

CameraInfoMessage from_port(const PortCalibration& c) {
  CameraInfoMessage out;
  out.width_px = static_cast<std::uint32_t>(c.width_px);
  out.height_px = static_cast<std::uint32_t>(c.height_px);
  out.distortion_model = c.distortion_model;
  out.d = c.D;
  out.k = c.K;
  return out;
}

PortTrack port_track(const WorldTrack& track, const ObjectCatalogue& catalogue) {
  PortTrack out;
  out.id = track.id;
  out.class_name = track.class_name;
  out.person = catalogue.is_person(track.class_name);
  out.position_m = port_vector(track.position_m);
  out.velocity_m_s = port_vector(track.velocity_m_s);
  out.extent_m = port_vector(track.extent_m);
  for (int i = 0; i < 9; ++i) {
    out.covariance_m2[static_cast<std::size_t>(i)] = track.position_covariance_m2(i / 3, i % 3);
  }
  out.age_s = track.age_s;
  out.unseen_s = track.unseen_s;
  out.moves = track.moves;
  return out;
}

/// Of the robot's pose: its origin lies off the camera's, so that rotation moves it as well.
Matrix6d at_robot(const Matrix6d& covariance, const Eigen::Vector3d& arm_map_m) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -skew(arm_map_m);
  return J * covariance * J.transpose();
}

Matrix6d turned(const Matrix6d& covariance, const Eigen::Matrix3d& R) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
  return turn * covariance * turn.transpose();
}

/// The velocity of the robot's origin, which turns with the camera, in the robot's axes.
std::array<double, 6> velocity_of_robot(const Vector6d& v_camera, const SE3& T_robot_camera) {
  const Eigen::Vector3d omega = T_robot_camera.rotation() * v_camera.tail<3>();
  const Eigen::Vector3d v =
      T_robot_camera.rotation() * v_camera.head<3>() + omega.cross(-T_robot_camera.translation());
  return {v.x(), v.y(), v.z(), omega.x(), omega.y(), omega.z()};
}

/// As ReckoningOptions has it.
std::string mounting_text(const SE3& T) {
  const PortPose p = port_pose(T);
  return fmt::format("{} {} {} {} {} {} {}", p.position_m[0], p.position_m[1], p.position_m[2],
                     p.orientation[0], p.orientation[1], p.orientation[2], p.orientation[3]);
}

PortAnswer answer(const Result<void>& done, std::string text) {
  return done ? PortAnswer{true, std::move(text)} : PortAnswer{false, done.error().message};
}

}  // namespace

struct RobotPort::State {
  RobotOptions options;
  PortSettings settings;
  std::unique_ptr<RobotSlam> slam;  ///< null before the start
  SE3 T_robot_camera;
  bool find_floor = true;  ///< of grids
  std::optional<RgbdFrame> picture;
  std::optional<FrameReport> report;
  Published<const RobotMap> map;  ///< for cloud and grid

  void publish_map() { map.set(slam->newest_map()); }
  Result<RgbdFrame> frame_of(std::int64_t stamp_ns, const PortImage& colour,
                             const PortImage& depth) const;
  PortFrame told(const RobotFrame& frame) const;
};

RobotPort::Opened RobotPort::open(const std::vector<std::string>& parameters) {
  Result<RobotOptions> options = robot_options(parameters);
  if (!options) return {nullptr, options.error().message};
  auto state = std::make_unique<State>();
  state->options = *std::move(options);
  const RobotOptions& o = state->options;
  state->settings = {o.map_frame,       o.odom_frame, o.base_frame,   o.publish_tf,
                     o.publish_odom_tf, o.use_imu,    o.use_odometry, o.max_difference_s,
                     o.path_hz,         o.compressed};
  return {std::unique_ptr<RobotPort>(new RobotPort(std::move(state))), {}};
}

RobotPort::RobotPort(std::unique_ptr<State> state) : state_(std::move(state)) {}
RobotPort::~RobotPort() = default;

const PortSettings& RobotPort::settings() const { return state_->settings; }
bool RobotPort::started() const { return state_->slam != nullptr; }

PortAnswer RobotPort::start(const PortCalibration& calibration, const PortPose& T_robot_camera,
                            bool robot_frame) {
  State& s = *state_;
  s.T_robot_camera = from_port(T_robot_camera);
  s.find_floor = s.options.grid_floor == GridFloor::seen ||
                 (s.options.grid_floor == GridFloor::automatic && !robot_frame);
  if (robot_frame)
    s.options.system.reckoning.T_camera_base = mounting_text(s.T_robot_camera.inverse());
  const Result<void> done = guarded("", [&]() -> Result<void> {
    Result<RobotSetup> setup = robot_setup(s.options, from_port(calibration),
                                           robot_frame ? s.T_robot_camera : axes_of_robots());
    if (!setup) return setup.error();
    Result<RobotSlam> slam = RobotSlam::make(*std::move(setup), s.options.map_file);
    if (!slam) return slam.error();
    slam->set_localization_only(s.options.localization_only);
    s.slam = std::make_unique<RobotSlam>(*std::move(slam));
    s.publish_map();
    return {};
  });
  if (!done) return {false, done.error().message};
  const Camera& camera = s.slam->setup().camera;
  return {true,
          fmt::format("{} x {} px, fx {:.1f}", camera.width_px, camera.height_px, camera.fx_px)};
}

Result<RgbdFrame> RobotPort::State::frame_of(std::int64_t stamp_ns, const PortImage& colour,
                                             const PortImage& depth) const {
  const Camera& camera = slam->setup().camera;
  Result<ColourImage> seen =
      colour.compressed ? colour_of(packed_from_port(colour)) : colour_of(from_port(colour));
  if (!seen) return seen.error();
  Result<DepthImage> depth_m = depth.compressed ? depth_of(packed_from_port(depth), camera)
                                                : depth_of(from_port(depth), camera);
  if (!depth_m) return depth_m.error();
  const auto fits = [&](const auto& image) {
    return image.width() == camera.width_px && image.height() == camera.height_px;
  };
  if (!fits(*seen) || !fits(*depth_m)) {
    return Error{fmt::format(
        "colour is {} x {} px, depth {} x {}, the camera {} x {}: depth must be registered to "
        "colour (depth_registered) and of its size",
        seen->width(), seen->height(), depth_m->width(), depth_m->height(), camera.width_px,
        camera.height_px)};
  }
  return RgbdFrame{0, Timestamp{stamp_ns}, to_grey(*seen), *seen, *depth_m};
}

PortFrame RobotPort::push(std::int64_t stamp_ns, const PortImage& colour, const PortImage& depth) {
  State& s = *state_;
  PortFrame out;
  if (!s.slam) {
    out.failure = "the system has not been started";
    return out;
  }
  const Result<void> done = guarded("", [&]() -> Result<void> {
    Result<RgbdFrame> frame = s.frame_of(stamp_ns, colour, depth);
    if (!frame) return frame.error();
    Result<RobotFrame> pushed = s.slam->push(*frame);
    if (!pushed) return pushed.error();
    s.publish_map();
    out = s.told(*pushed);
    s.picture = *std::move(frame);
    s.report = std::move(pushed->report);
    return {};
  });
  if (!done) out.failure = done.error().message;
  return out;
}

PortFrame RobotPort::State::told(const RobotFrame& frame) const {
  const FrameReport& r = frame.report;
  PortFrame out;
  out.state = std::string(to_string(r.track.state));
  out.doubt = r.track.doubt;
  out.tracking = r.track.state == TrackingState::tracking;
  out.has_pose = frame.has_pose;
  const SE3 T_camera_robot = T_robot_camera.inverse();
  out.T_map_robot = port_pose(frame.T_map_camera * T_camera_robot);
  out.T_odom_robot = port_pose(frame.T_odom_camera * T_camera_robot);
  out.T_map_odom = port_pose(frame.T_map_odom);
  const Matrix6d covariance =
      at_robot(frame.covariance, frame.T_map_camera.rotation() * T_camera_robot.translation());
  out.covariance = port_matrix(covariance);
  out.odom_covariance =
      port_matrix(turned(covariance, frame.T_map_odom.rotation_matrix().transpose()));
  out.velocity = velocity_of_robot(frame.velocity, T_robot_camera);
  for (const WorldTrack& track : frame.tracks) {
    out.tracks.push_back(port_track(track, slam->setup().catalogue));
  }
  out.tracks_json = to_json_line({r.index, r.stamp, -1, frame.tracks});
  return out;
}

void RobotPort::add_imu(const PortImu& s) {
  if (!state_->slam) return;
  state_->slam->add(ImuSample{{s.stamp_ns},
                              {s.gyro_rad_s[0], s.gyro_rad_s[1], s.gyro_rad_s[2]},
                              {s.accel_m_s2[0], s.accel_m_s2[1], s.accel_m_s2[2]}});
}

void RobotPort::add_odometry(std::int64_t stamp_ns, const PortPose& T_odom_robot) {
  if (state_->slam) state_->slam->add(OdometryPose{{stamp_ns}, from_port(T_odom_robot)});
}

PortPicture RobotPort::annotated() const {
  const State& s = *state_;
  if (!s.picture || !s.report) return {};
  const ColourImage drawn = annotate(*s.picture, *s.report, s.slam->setup().catalogue);
  PortPicture out{drawn.width(), drawn.height(), {}};
  out.bgr.resize(3 * static_cast<std::size_t>(drawn.width()) *
                 static_cast<std::size_t>(drawn.height()));
  std::memcpy(out.bgr.data(), drawn.data(), out.bgr.size());
  return out;
}

PortAnswer RobotPort::save_map(const std::string& file) {
  if (!state_->slam) return {false, "there is no map yet"};
  if (file.empty()) return {false, "the parameter save_file names no file"};
  return answer(guarded(file, [&] { return state_->slam->save_map(file); }), "saved to " + file);
}

PortAnswer RobotPort::load_map(const std::string& file) {
  State& s = *state_;
  if (file.empty()) return {false, "the parameter map_file names no file"};
  s.options.map_file = file;
  if (!s.slam) return {true, "will be loaded with the first pictures: " + file};
  const Result<void> done = guarded(file, [&] { return s.slam->load_map(file); });
  s.publish_map();
  return answer(done, "loaded " + file);
}

PortAnswer RobotPort::reset() {
  State& s = *state_;
  if (!s.slam) return {false, "there is no map yet"};
  s.slam->reset();
  s.publish_map();
  return {true, "map and path forgotten"};
}

PortAnswer RobotPort::set_localization_only(bool on) {
  state_->options.localization_only = on;
  if (state_->slam) state_->slam->set_localization_only(on);
  return {true, on ? "the map stays as it is" : "the map grows"};
}

PortAnswer RobotPort::finish() {
  State& s = *state_;
  if (!s.slam) return {true, "nothing was seen"};
  const Result<void> done = guarded("", [&] { return s.slam->finish(Ending::prompt); });
  PortAnswer saved{true, "ended"};
  // A map of nothing replaces none.
  const bool worth = !s.slam->newest_map()->atlas->keyframes().empty();
  if (!s.options.save_file.empty() && worth) saved = save_map(s.options.save_file);
  return done ? saved : PortAnswer{false, done.error().message};
}

std::vector<PortStampedPose> RobotPort::path(std::size_t most) const {
  std::vector<PortStampedPose> out;
  if (!state_->slam) return out;
  const StampedPoses poses = state_->slam->path();
  const SE3 T_camera_robot = state_->T_robot_camera.inverse();
  const std::size_t step = poses.size() / std::max<std::size_t>(1, most) + 1;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i % step != 0 && i + 1 != poses.size()) continue;
    out.push_back({poses[i].stamp.ns, port_pose(poses[i].T_world_camera * T_camera_robot)});
  }
  return out;
}

std::vector<PortPoint> RobotPort::points() const {
  std::vector<PortPoint> out;
  const auto map = state_->map.get();
  if (!map) return out;
  for (const Eigen::Vector3f& p : points_of(*map)) out.push_back({p.x(), p.y(), p.z(), {}});
  return out;
}

PortCounts RobotPort::counts() const {
  const auto map = state_->map.get();
  if (!map) return {0, 0, 0, state_->options.localization_only};
  return {map->atlas->keyframes().size(), map->atlas->points().size(), state_->slam->loops(),
          state_->slam->localization_only()};
}

PortCloud RobotPort::cloud() const {
  const auto map = state_->map.get();
  PortCloud out;
  const Result<void> done = guarded("", [&]() -> Result<void> {
    if (!map) return Error{"there is no map yet"};
    const Result<std::vector<CloudPoint>> cloud = cloud_of(*map, state_->options.grid.cloud);
    if (!cloud) return cloud.error();
    if (cloud->empty()) return Error{"the map holds no pictures to make a cloud of"};
    for (const CloudPoint& p : *cloud) {
      out.points.push_back({p.p_world.x(), p.p_world.y(), p.p_world.z(), p.colour});
    }
    return {};
  });
  if (!done) out.failure = done.error().message;
  return out;
}

PortGrid RobotPort::grid() const {
  const auto map = state_->map.get();
  PortGrid out;
  const Result<void> done = guarded("", [&]() -> Result<void> {
    if (!map) return Error{"there is no map yet"};
    const Result<OccupancyGrid> grid = grid_of(*map, state_->options.grid, state_->find_floor);
    if (!grid) return grid.error();
    if (grid->empty()) return Error{"the map holds no pictures to make a grid of"};
    out.resolution_m = grid->resolution_m;
    out.columns = grid->columns;
    out.rows = grid->rows;
    const SE3 T_grid_origin(Eigen::Matrix3d::Identity(),
                            Eigen::Vector3d(grid->origin_m.x(), grid->origin_m.y(), 0));
    out.T_map_origin = port_pose(map->T_map_world * grid->T_grid_world.inverse() * T_grid_origin);
    for (const Cell cell : grid->cells) out.cells.push_back(static_cast<std::int8_t>(cell));
    return {};
  });
  if (!done) out.failure = done.error().message;
  return out;
}

}  // namespace ydd
