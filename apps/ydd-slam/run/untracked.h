// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/dataset/sequence.h"
#include "ydd/system/slam_system.h"

namespace ydd::app {

/// Gathers, while no frame has been tracked, what could be the reason.
class Untracked {
 public:
  Untracked(const Sequence& sequence, const Camera& camera, bool in_known_map)
      : sequence_(sequence), camera_(camera), in_known_map_(in_known_map) {}

  void add(const RgbdFrame& frame, const FrameReport& report);

  /// Why not one frame was tracked, and what may help: one line.
  std::string reason() const;

 private:
  std::string depth_reason() const;

  const Sequence& sequence_;
  const Camera& camera_;
  bool in_known_map_;
  bool tracked_ = false;
  int frames_ = 0;
  int dark_ = 0;                 ///< frames without any contrast
  int without_depth_ = 0;        ///< frames without one reading in range
  std::size_t most_points_ = 0;  ///< with depth, kept, in one frame
  std::size_t most_rejected_ = 0;
  std::int64_t first_ = -1;
};

}  // namespace ydd::app
