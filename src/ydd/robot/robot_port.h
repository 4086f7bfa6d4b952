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
  std::array<double, 3> position_m{};             ///< x y z
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< quaternion x y z w
};

/// A picture in the caller's memory, as sensor_msgs/Image has it.
struct PortImage {
  int width_px = 0, height_px = 0;      ///< of the picture
  std::size_t step_bytes = 0;           ///< from one row to the next
  std::string encoding;                 ///< "rgb8", "bgr8", "mono8", "16UC1", "32FC1", ...
  bool big_endian = false;              ///< order of bytes in what has 16 or 32 bits
  const std::uint8_t* bytes = nullptr;  ///< the first of them, the caller's
  std::size_t size_bytes = 0;           ///< of all rows
  bool compressed = false;  ///< as sensor_msgs/CompressedImage has it: `encoding` is its format
};

/// As sensor_msgs/CameraInfo has it.
struct PortCalibration {
  int width_px = 0, height_px = 0;  ///< of the pictures that it holds for
  std::array<double, 9> K{};        ///< of the pinhole, row by row
  std::vector<double> D;            ///< distortion, as the model orders it
  std::string distortion_model;     ///< "plumb_bob" or "rational_polynomial"
};

/// A person or moving thing, map frame (WorldTrack).
struct PortTrack {
  std::int64_t id = 0;     ///< the same as long as it is followed
  std::string class_name;  ///< as the detector named it; "thing": it did not
  bool person = false;     ///< whether its class is that of people
  /// Middle of it and how it moves, metres and seconds.
  std::array<double, 3> position_m{}, velocity_m_s{};
  std::array<double, 3> extent_m{};       ///< width, height, depth for the camera
  std::array<double, 9> covariance_m2{};  ///< of the position, row by row
  double age_s = 0, unseen_s = 0;         ///< since it was first and last seen
  bool moves = false;                     ///< as judged when seen last
};

/// As sensor_msgs/Imu has it, in the sensor's frame (option reckoning.T_camera_imu).
struct PortImu {
  std::int64_t stamp_ns = 0;  ///< when it was read
  /// Rate of turn, and what it feels: at rest g upwards.
  std::array<double, 3> gyro_rad_s{}, accel_m_s2{};
};

/// What became of one pair of pictures. The robot is its base frame, or the camera.
struct PortFrame {
  std::string failure;  ///< one line; empty: none, and all below holds
  std::string state;    ///< "tracking", "lost", ...
  std::string doubt;    ///< why it is not believed though it tracks; empty: it is
  /// Whether the camera sees the map, and whether it is known where it is.
  bool tracking = false, has_pose = false;
  /// Where the robot is, and what the map corrects of the odometry.
  PortPose T_map_robot, T_odom_robot, T_map_odom;
  std::array<double, 36> covariance{};  ///< of T_map_robot: x y z, then about x y z; row by row
  std::array<double, 36> odom_covariance{};  ///< the same in the axes of odom
  std::array<double, 6> velocity{};          ///< of the robot in its own axes: m/s, then rad/s
  std::vector<PortTrack> tracks;             ///< people and moving things, map frame
  std::string tracks_json;                   ///< one line, as in tracks.jsonl, map frame
};

/// A point of the map's frame.
struct PortPoint {
  float x = 0, y = 0, z = 0;          ///< metres, map frame
  std::array<std::uint8_t, 3> bgr{};  ///< blue green red
};
/// The dense static cloud.
struct PortCloud {
  std::string failure;            ///< empty: none
  std::vector<PortPoint> points;  ///< of the static scene, map frame
};
/// Where a robot can go.
struct PortGrid {
  std::string failure;             ///< one line; empty: none
  double resolution_m = 0;         ///< edge of a cell, metres
  int columns = 0, rows = 0;       ///< along x and y of the grid
  PortPose T_map_origin;           ///< of the corner of the first cell; tilted with a floor that is
  std::vector<std::int8_t> cells;  ///< row by row: -1 unknown, 0 free, 100 occupied
};
/// A pose of the path.
struct PortStampedPose {
  std::int64_t stamp_ns = 0;  ///< of the picture
  PortPose T_map_robot;       ///< as the newest state of the map has it
};
/// A picture to be shown.
struct PortPicture {
  int width_px = 0, height_px = 0;  ///< of the picture
  std::vector<std::uint8_t> bgr;    ///< row by row, without gaps
};

/// How large the map is.
struct PortCounts {
  std::size_t keyframes = 0, points = 0;  ///< in all maps of the run
  int loops = 0;                          ///< that were closed since the map was new
  bool localization_only = false;         ///< whether the map is used without being changed
};

/// What the node itself has to know of its parameters.
struct PortSettings {
  std::string map_frame, odom_frame, base_frame;  ///< names of the frames of REP 105
  /// Whether the node tells other nodes of map -> odom, and of odom -> robot.
  bool publish_tf = true, publish_odom_tf = true;
  bool use_imu = false, use_odometry = false;  ///< whether it listens to an IMU, to wheel odometry
  /// Between colour and depth of a pair; how often a path is sent.
  double max_difference_s = 0, path_hz = 0;
  bool compressed = false;  ///< whether pictures come compressed
};

/// What a service answers.
struct PortAnswer {
  bool done = false;  ///< whether it could be
  std::string text;   ///< one line
};

/// Thread: one, but for `cloud` and `grid`, which may be called by another at the same time.
class RobotPort {
 public:
  /// A port, or why there is none.
  struct Opened {
    std::unique_ptr<RobotPort> port;  ///< null: see failure
    std::string failure;              ///< one line that tells what to do; empty: none
  };
  /// `parameters`: "key=value" (RobotOptions). Nothing is loaded yet.
  static Opened open(const std::vector<std::string>& parameters);
  ~RobotPort();
  RobotPort(const RobotPort&) = delete;
  RobotPort& operator=(const RobotPort&) = delete;

  const PortSettings& settings() const;  ///< What the parameters say; the same at all times.

  /// Once, before the first pictures: loads network and map. `T_robot_camera`: of the camera's
  /// optical frame on the robot. `robot_frame` decides where the map begins: below the robot, or
  /// (false) in the camera.
  PortAnswer start(const PortCalibration& calibration, const PortPose& T_robot_camera,
                   bool robot_frame);
  bool started() const;  ///< Whether start() has succeeded.

  /// Depth must be registered to colour. What cannot be processed costs nothing but itself.
  PortFrame push(std::int64_t stamp_ns, const PortImage& colour, const PortImage& depth);
  /// Other senses predict the motion and bridge what the camera does not see. Samples come in the
  /// order of time; before the start they are left out. Odometry is that of the robot's frame, or
  /// (without one) of what option reckoning.T_camera_base says.
  void add_imu(const PortImu& sample);
  /// Where the robot is by its wheels, before the picture that is not earlier.
  void add_odometry(std::int64_t stamp_ns, const PortPose& T_odom_robot);

  /// The picture of the newest frame with boxes, points and state.
  PortPicture annotated() const;

  /// Whole or not at all; the answer's text names the file.
  PortAnswer save_map(const std::string& file);
  /// Goes on in the map of a file; the one there is stays if that fails.
  PortAnswer load_map(const std::string& file);
  PortAnswer reset();  ///< Forgets map and path; the next picture starts anew.
  /// From now on the map is used without being changed, or not.
  PortAnswer set_localization_only(bool on);
  /// The end: what there is to save is saved.
  PortAnswer finish();

  /// Where the robot was, as the newest map has it: about `most` poses, evenly chosen.
  std::vector<PortStampedPose> path(std::size_t most) const;
  std::vector<PortPoint> points() const;  ///< The points by which the camera is tracked, map frame.
  PortCounts counts() const;              ///< As they are now.
  PortCloud cloud() const;                ///< The dense static cloud. Any thread.
  PortGrid grid() const;                  ///< The floor as cells. Any thread.

 private:
  struct State;
  explicit RobotPort(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ydd
