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

std::string_view ros2_definition(std::string_view type) {
  if (type == "sensor_msgs/msg/Image") return kImage;
  if (type == "sensor_msgs/msg/CameraInfo") return kCameraInfo;
  return {};
}

}  // namespace ydd
