// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "ydd/base/timestamp.h"
#include "ydd/image/image.h"

namespace ydd {

/// A picture as a camera gives it.
template <class Picture>
struct LivePicture {
  Timestamp device;   ///< by the clock of the camera
  Timestamp arrived;  ///< by that of the machine
  Picture picture;
};
using LiveColour = LivePicture<ColourImage>;
using LiveDepth = LivePicture<RawDepthImage>;

/// Finds for each colour picture the depth picture nearest in time, while they come.
class LivePairing {
 public:
  /// Pictures farther apart are no pair.
  explicit LivePairing(double max_difference_s);

  /// In the order of time, each.
  void add(LiveColour colour);
  void add(LiveDepth depth);

  /// Two pictures of the same moment.
  struct Pair {
    LiveColour colour;
    LiveDepth depth;
  };
  /// The oldest pair; nothing when a better partner may still come.
  std::optional<Pair> take();
  /// Forgets what waits: the camera was gone.
  void clear();

  std::int64_t unpaired() const { return unpaired_; }

 private:
  std::int64_t most_ns_;
  std::deque<LiveColour> colours_;
  std::deque<LiveDepth> depths_;
  std::int64_t unpaired_ = 0;
};

}  // namespace ydd
