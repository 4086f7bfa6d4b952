// SPDX-License-Identifier: Apache-2.0
#pragma once

// Nodes of ROS 1 and 2 are C++17: nothing here needs more, and no header of the project is
// included.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// What a node of a robot's middleware needs of the project, as plain values: pictures go in;
/// poses, people, clouds and grids come out, in the frames of REP 105 (x ahead, y left, z up).
namespace ydd {

/// A rigid motion.
struct PortPose {
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< quaternion x y z w
};

/// A picture in the caller's memory, as sensor_msgs/Image has it.
struct PortImage {
  int width_px = 0, height_px = 0;
  std::size_t step_bytes = 0;
  std::string encoding;
  bool big_endian = false;
  const std::uint8_t* bytes = nullptr;
  std::size_t size_bytes = 0;
  bool compressed = false;  ///< as sensor_msgs/CompressedImage has it: `encoding` is its format
};

/// As sensor_msgs/CameraInfo has it.
struct PortCalibration {
  int width_px = 0, height_px = 0;
  std::array<double, 9> K{};
  std::vector<double> D;
  std::string distortion_model;
};

/// A person or moving thing, map frame (WorldTrack).
struct PortTrack {
  std::int64_t id = 0;
  std::string class_name;
  bool person = false;
  std::array<double, 3> position_m{}, velocity_m_s{};
  std::array<double, 3> extent_m{};       ///< width, height, depth for the camera
  std::array<double, 9> covariance_m2{};  ///< of the position, row by row
  double age_s = 0, unseen_s = 0;
  bool moves = false;
};

/// As sensor_msgs/Imu has it, in the sensor's frame (option reckoning.T_camera_imu).
struct PortImu {
  std::int64_t stamp_ns = 0;
  std::array<double, 3> gyro_rad_s{}, accel_m_s2{};
};

/// What became of one pair of pictures. The robot is its base frame, or the camera.
struct PortFrame {
  std::string failure;  ///< one line; empty: none, and all below holds
  std::string state;    ///< "tracking", "lost", ...
  std::string doubt;
  bool tracking = false, has_pose = false;
  PortPose T_map_robot, T_odom_robot, T_map_odom;
  std::array<double, 36> covariance{};  ///< of T_map_robot: x y z, then about x y z; row by row
  std::array<double, 36> odom_covariance{};  ///< the same in the axes of odom
  std::array<double, 6> velocity{};          ///< of the robot in its own axes: m/s, then rad/s
  std::vector<PortTrack> tracks;
  std::string tracks_json;  ///< one line, as in tracks.jsonl, map frame
};

/// A point of the map's frame.
struct PortPoint {
  float x = 0, y = 0, z = 0;
  std::array<std::uint8_t, 3> bgr{};
};
/// The dense static cloud.
struct PortCloud {
  std::string failure;  ///< empty: none
  std::vector<PortPoint> points;
};
/// Where a robot can go.
struct PortGrid {
  std::string failure;
  double resolution_m = 0;
  int columns = 0, rows = 0;
  PortPose T_map_origin;           ///< of the corner of the first cell; tilted with a floor that is
  std::vector<std::int8_t> cells;  ///< row by row: -1 unknown, 0 free, 100 occupied
};
/// A pose of the path.
struct PortStampedPose {
  std::int64_t stamp_ns = 0;
  PortPose T_map_robot;
};
/// A picture to be shown.
struct PortPicture {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> bgr;  ///< row by row, without gaps
};

/// How large the map is.
struct PortCounts {
  std::size_t keyframes = 0, points = 0;
  int loops = 0;
  bool localization_only = false;
};

/// What the node itself has to know of its parameters.
struct PortSettings {
  std::string map_frame, odom_frame, base_frame;
  bool publish_tf = true, publish_odom_tf = true;
  bool use_imu = false, use_odometry = false;
  double max_difference_s = 0, path_hz = 0;
  bool compressed = false;
};

/// What a service answers.
struct PortAnswer {
  bool done = false;
  std::string text;  ///< one line
};

/// Thread: one, but for `cloud` and `grid`, which may be called by another at the same time.
class RobotPort {
 public:
  /// A port, or why there is none.
  struct Opened {
    std::unique_ptr<RobotPort> port;  ///< null: see failure
    std::string failure;
  };
  /// `parameters`: "key=value" (RobotOptions). Nothing is loaded yet.
  static Opened open(const std::vector<std::string>& parameters);
  ~RobotPort();
  RobotPort(const RobotPort&) = delete;
  RobotPort& operator=(const RobotPort&) = delete;

  const PortSettings& settings() const;

  /// Once, before the first pictures: loads network and map. `T_robot_camera`: of the camera's
  /// optical frame on the robot. `robot_frame` decides where the map begins: below the robot, or
  /// (false) in the camera.
  PortAnswer start(const PortCalibration& calibration, const PortPose& T_robot_camera,
                   bool robot_frame);
  bool started() const;

  /// Depth must be registered to colour. What cannot be processed costs nothing but itself.
  PortFrame push(std::int64_t stamp_ns, const PortImage& colour, const PortImage& depth);
  /// Other senses predict the motion and bridge what the camera does not see. Samples come in the
  /// order of time; before the start they are left out. Odometry is that of the robot's frame, or
  /// (without one) of what option reckoning.T_camera_base says.
  void add_imu(const PortImu& sample);
  void add_odometry(std::int64_t stamp_ns, const PortPose& T_odom_robot);

  /// The picture of the newest frame with boxes, points and state.
  PortPicture annotated() const;

  PortAnswer save_map(const std::string& file);
  PortAnswer load_map(const std::string& file);
  PortAnswer reset();
  PortAnswer set_localization_only(bool on);
  /// The end: what there is to save is saved.
  PortAnswer finish();

  std::vector<PortStampedPose> path(std::size_t most) const;
  std::vector<PortPoint> points() const;
  PortCounts counts() const;
  PortCloud cloud() const;
  PortGrid grid() const;

 private:
  struct State;
  explicit RobotPort(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ydd
