// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "ydd/base/result.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/image.h"

/// Pictures as drivers of robots publish them (sensor_msgs/Image of ROS, any version).
namespace ydd {

/// A picture in somebody else's memory.
struct SensorImage {
  int width_px = 0, height_px = 0;
  std::size_t step_bytes = 0;  ///< from row to row
  std::string encoding;        ///< as in sensor_msgs/image_encodings.h
  bool big_endian = false;
  std::span<const std::uint8_t> bytes;
};

/// rgb8, bgr8, rgba8, bgra8, mono8 (and 8UC1, 8UC3, 8UC4, which are taken for grey, BGR and BGRA).
/// Failure: one line with what it is and what is read.
Result<ColourImage> colour_of(const SensorImage& image);

/// 16UC1 and mono16 (millimetres, REP 118) and 32FC1 (metres; no reading: NaN or not above 0).
/// Readings outside the camera's limits become 0; the camera's own scale is not asked.
Result<DepthImage> depth_of(const SensorImage& image, const Camera& camera);

/// The calibration of a camera as sensor_msgs/CameraInfo has it.
struct SensorCalibration {
  int width_px = 0, height_px = 0;
  std::array<double, 9> K{};
  std::vector<double> D;
  std::string distortion_model;
};
/// Depth in millimetres. Fails on a camera that is not calibrated (K is 0), on other lens models
/// than plumb_bob, and on what check_camera refuses.
Result<Camera> camera_of(const SensorCalibration& calibration);

}  // namespace ydd
