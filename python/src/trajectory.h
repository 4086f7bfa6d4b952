// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "binding.h"
#include "ydd/dataset/trajectory.h"

namespace ydd::python {

/// Poses of a camera by rising time: a class of its own, so that lists of other things are not
/// taken for one.
struct Trajectory {
  StampedPoses poses;
};

}  // namespace ydd::python
