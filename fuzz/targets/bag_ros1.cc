// SPDX-License-Identifier: Apache-2.0
#include "bag_reading.h"
#include "targets.h"

namespace ydd::fuzz {

// A file that is a bag of ROS 1.
void bag_ros1(std::string_view input) { read_bag(input, "a.bag"); }

}  // namespace ydd::fuzz
