// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/messages/ros_messages.h"
#include "ydd/robot/robot_options.h"
#include "ydd/robot/robot_slam.h"

namespace ydd {

/// The system as the options want it, with the camera that they name or that was calibrated.
Result<RobotSetup> robot_setup(const RobotOptions& options, const CameraInfoMessage& calibration,
                               const SE3& T_map_world);

}  // namespace ydd
