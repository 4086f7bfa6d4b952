// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "ydd/bags/bag.h"
#include "ydd/dataset/recording.h"

/// What a bag tells of motion. Inside this room only.
namespace ydd::sources {

/// Its topics of sensor_msgs/Imu and nav_msgs/Odometry; null: it has none. `file`: for messages.
/// Stamps are those of the headers; what is out of order is sorted, of two with one stamp the first
/// counts. A reading that no such sensor gives (another unit?) or a sensor that does not measure
/// what is needed is an error, a message that is damaged is left out with a warning.
std::shared_ptr<const MotionStore> bag_motion(std::shared_ptr<const Bag> bag,
                                              const std::filesystem::path& file);

}  // namespace ydd::sources
