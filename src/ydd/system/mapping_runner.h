// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ydd/loop/loop_closer.h"
#include "ydd/mapping/mapper.h"

namespace ydd {

/// A loop that was closed, for reports.
struct LoopReport {
  KeyFrameId current, matched;
  std::int64_t current_frame = 0, matched_frame = 0;
  int inliers = 0;
  double shift_m = 0;     ///< how far the keyframe had drifted
  bool welded = false;    ///< two maps became one
  SE3 T_matched_current;  ///< as measured
};

/// Everything that the back end did.
struct MappingReports {
  std::vector<MapperReport> keyframes;  ///< one per keyframe, in order
  std::vector<LoopReport> loops;
  StageTimes loop_times;  ///< of the loop closer, per keyframe and per loop
};

/// Puts mapper and loop closer somewhere: into the caller's thread, or into threads of their own.
class MappingRunner {
 public:
  virtual ~MappingRunner() = default;
  /// Hands over a candidate. False if the mapper is too far behind to take it. A candidate that
  /// starts a map is always taken, and the map is there when the call returns.
  virtual bool submit(KeyFrameCandidate candidate) = 0;
  /// No candidate waits or is being worked on.
  virtual bool idle() const = 0;
  /// The newest published map; never null.
  virtual std::shared_ptr<const Atlas> atlas() const = 0;
  /// Works off what waits and stops. Further candidates are refused.
  virtual void finish() = 0;
  /// Complete after `finish`.
  virtual MappingReports reports() const = 0;
};

/// Mapper and loop closer in the caller's thread: deterministic.
std::unique_ptr<MappingRunner> make_inline_mapping(Mapper mapper, const LoopOptions& options);
/// Mapper and loop closer in a thread each.
std::unique_ptr<MappingRunner> make_threaded_mapping(Mapper mapper, const LoopOptions& options);

}  // namespace ydd
