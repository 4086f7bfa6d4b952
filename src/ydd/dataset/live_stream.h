// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/dataset/depth_shift.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/rgbd_frame.h"

namespace ydd {

/// A colour picture and the depth picture that belongs to it, as a camera gave them.
struct LivePair {
  Timestamp stamp;      ///< of the colour picture; of one stream strictly increasing
  ColourImage colour;   ///< as it came, blue green red
  RawDepthImage depth;  ///< registered to colour, counts of the camera's depth scale
};

/// What came from a camera so far.
struct LiveCounts {
  std::int64_t arrived = 0;   ///< colour pictures
  std::int64_t dropped = 0;   ///< of these, because nobody took them in time
  std::int64_t unpaired = 0;  ///< of these, for want of a depth picture
  int pauses = 0;             ///< times that no picture came for long
  int unplugged = 0;          ///< times that the camera was gone

  bool operator==(const LiveCounts&) const = default;
};

/// A camera that is being looked through. It goes on by itself; what nobody takes in time gives way
/// to what is newer. A camera that is unplugged is waited for, and goes on when it is back.
///
/// Thread: one takes.
class LiveStream {
 public:
  LiveStream() = default;
  virtual ~LiveStream() = default;
  LiveStream(const LiveStream&) = delete;
  LiveStream& operator=(const LiveStream&) = delete;

  /// The next pair; nothing when none came within `wait`, or a signal asks to end.
  virtual std::optional<LivePair> next(std::chrono::milliseconds wait) = 0;

  virtual LiveCounts counts() const = 0;  ///< What came and what was lost until now.
};

/// Frame number `index` of a stream: depth in metres within the limits of `camera`, moved back by
/// `shift`. Fails when the pictures have not the camera's size.
Result<RgbdFrame> frame_of(const LivePair& pair, std::int64_t index, const Camera& camera,
                           const DepthShift& shift = {});

}  // namespace ydd
