// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ydd/base/timestamp.h"

namespace ydd {

/// Stamps of a device's own clock, which starts anywhere, as times of this machine: what lies
/// between two pictures is the device's, where it begins is ours. It is set anew when the device
/// comes back, or its clock jumps.
class DeviceClock {
 public:
  /// `device`: of the picture; `arrived`: when it came, by the machine's clock. Strictly
  /// increasing.
  Timestamp to_host(Timestamp device, Timestamp arrived);

  /// The device was gone: its clock starts anew.
  void restart() { before_.reset(); }

 private:
  struct Stamped {
    Timestamp device, arrived;
  };
  std::optional<Stamped> before_;  ///< the picture before
  std::int64_t offset_ns_ = 0;     ///< host minus device
  std::optional<Timestamp> newest_;
};

}  // namespace ydd
