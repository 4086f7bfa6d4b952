// SPDX-License-Identifier: Apache-2.0
#include "bag_reading.h"
#include "targets.h"

namespace ydd::fuzz {

// A file that is a bag of ROS 2 in SQLite.
void bag_sqlite(std::string_view input) { read_bag(input, "a.db3"); }

}  // namespace ydd::fuzz
