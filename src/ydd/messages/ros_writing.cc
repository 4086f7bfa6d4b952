// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_writing.h"

#include <utility>

#include "ydd/messages/wire_writer.h"

namespace ydd {
namespace {

constexpr std::string_view kImage =
    "std_msgs/Header header\n"
    "uint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

constexpr std::string_view kCameraInfo =
    "std_msgs/Header header\n"
    "uint32 height\nuint32 width\nstring distortion_model\n"
    "float64[] d\nfloat64[9] k\nfloat64[9] r\nfloat64[12] p\n"
    "uint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n"
    "================================================================================\n"
    "MSG: sensor_msgs/RegionOfInterest\n"
    "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

constexpr std::string_view kImu =
    "std_msgs/Header header\n"
    "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

constexpr std::string_view kOdometry =
    "std_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"
    "================================================================================\n"
    "MSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    "================================================================================\n"
    "MSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// Zeros; where something is not measured, as sensor_msgs/Imu says that.
void put_covariance(WireWriter& out, int size, bool measured) {
  out.f64(measured ? 0 : -1);
  for (int i = 1; i < size; ++i) out.f64(0);
}

}  // namespace

std::string write_image(const ImageMessage& image, Wire wire) {
  WireWriter out(wire);
  out.header(image.stamp, image.frame).u32(image.height_px).u32(image.width_px);
  out.string(image.encoding).u8(image.big_endian ? 1 : 0).u32(image.step).bytes(image.data);
  return std::move(out).take();
}

std::string write_camera_info(const CameraInfoMessage& info, Wire wire) {
  WireWriter out(wire);
  out.header(info.stamp, info.frame).u32(info.height_px).u32(info.width_px);
  out.string(info.distortion_model).u32(static_cast<std::uint32_t>(info.d.size()));
  for (const double value : info.d) out.f64(value);
  for (const double value : info.k) out.f64(value);
  for (const double value : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) out.f64(value);
  for (const double value : info.p) out.f64(value);
  out.u32(0).u32(0);                      // binning
  out.u32(0).u32(0).u32(0).u32(0).u8(0);  // region of interest
  return std::move(out).take();
}

CameraInfoMessage camera_info_of(const Camera& camera, Timestamp stamp, std::string_view frame) {
  CameraInfoMessage out;
  out.stamp = stamp;
  out.frame = frame;
  out.width_px = static_cast<std::uint32_t>(camera.width_px);
  out.height_px = static_cast<std::uint32_t>(camera.height_px);
  out.distortion_model = "plumb_bob";
  out.d = {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
  out.k = {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
  out.p = {camera.fx_px, 0, camera.cx_px, 0, 0, camera.fy_px, camera.cy_px, 0, 0, 0, 1, 0};
  return out;
}

std::string write_imu(const ImuMessage& imu, Wire wire) {
  WireWriter out(wire);
  out.header(imu.stamp, imu.frame);
  for (const double value : {0.0, 0.0, 0.0, 1.0}) out.f64(value);
  put_covariance(out, 9, false);
  for (const double value : imu.turn_rad_s) out.f64(value);
  put_covariance(out, 9, imu.has_turn);
  for (const double value : imu.acceleration_m_s2) out.f64(value);
  put_covariance(out, 9, imu.has_acceleration);
  return std::move(out).take();
}

std::string write_odometry(const OdometryMessage& odometry, Wire wire) {
  WireWriter out(wire);
  out.header(odometry.stamp, odometry.frame).string(odometry.child_frame);
  for (const double value : odometry.position_m) out.f64(value);
  for (const double value : odometry.orientation) out.f64(value);
  put_covariance(out, 36, true);
  for (int i = 0; i < 6; ++i) out.f64(0);
  put_covariance(out, 36, true);
  return std::move(out).take();
}

std::string_view ros2_definition(std::string_view type) {
  if (type == "sensor_msgs/msg/Imu") return kImu;
  if (type == "nav_msgs/msg/Odometry") return kOdometry;
  if (type == "sensor_msgs/msg/Image") return kImage;
  if (type == "sensor_msgs/msg/CameraInfo") return kCameraInfo;
  return {};
}

}  // namespace ydd
