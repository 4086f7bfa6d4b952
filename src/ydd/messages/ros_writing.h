// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ydd/geometry/camera.h"
#include "ydd/messages/ros_messages.h"

namespace ydd {

/// The bytes of a message: what read_image, read_camera_info, ... read.
std::string write_image(const ImageMessage& image, Wire wire);

/// R is the identity; no binning, no region of interest.
std::string write_camera_info(const CameraInfoMessage& info, Wire wire);

/// The camera as a message: K and D as it is, P as K.
CameraInfoMessage camera_info_of(const Camera& camera, Timestamp stamp, std::string_view frame);

/// No orientation and no covariances; a turn or acceleration that there is not, is told so.
std::string write_imu(const ImuMessage& imu, Wire wire);
/// Covariances and velocities are 0.
std::string write_odometry(const OdometryMessage& odometry, Wire wire);

/// What a message of ROS 2 is made of, as its interface files say it, and those of what is in it:
/// what a bag of MCAP keeps beside its messages ("ros2msg"). Empty for types that are not written.
std::string_view ros2_definition(std::string_view type);

}  // namespace ydd
