// SPDX-License-Identifier: Apache-2.0
#include "bag_reading.h"
#include "targets.h"

namespace ydd::fuzz {

// A file that is an MCAP file.
void bag_mcap(std::string_view input) { read_bag(input, "a.mcap"); }

}  // namespace ydd::fuzz
