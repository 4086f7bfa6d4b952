// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/loop/loop_closer.h"
#include "ydd/mapping/mapper.h"

namespace ydd {

/// A loop that was closed, for reports.
struct LoopReport {
  KeyFrameId current, matched;  ///< the keyframe that saw a known place, and the one that shows it
  std::int64_t current_frame = 0, matched_frame = 0;  ///< their indices in the run
  int inliers = 0;                                    ///< points that agree about how the two lie
  double shift_m = 0;                                 ///< how far the keyframe had drifted
  bool merged = false;                                ///< two maps became one
  SE3 T_matched_current;                              ///< as measured
};

/// What became of the loop closer's work: everything that was asked for is counted somewhere.
struct LoopCounts {
  int keyframes_left_out = 0;       ///< not looked at: too far behind, or a prompt end
  int full_bundles = 0;             ///< done
  int full_bundles_merged = 0;      ///< one that was still to be done served for this loop as well
  int full_bundles_begun_anew = 0;  ///< interrupted by a newer loop in what they moved
  int rebased = 0;      ///< corrections that were carried over to a map that had moved on
  int refused = 0;      ///< corrections that came too late (Applied::refused)
  int interrupted = 0;  ///< pose graphs and bundles that a prompt end cut short or left out
};

/// Everything that the back end did.
struct MappingReports {
  std::vector<MapperReport> keyframes;  ///< one per keyframe, in order
  std::vector<LoopReport> loops;        ///< in the order in which they were closed
  LoopCounts loop_counts;               ///< of the loop closer: candidates, and what became of them
  StageTimes loop_times;                ///< of the loop closer, per keyframe and per loop
};

/// How a run ends.
enum class Ending {
  complete,  ///< what waits is worked off
  prompt,    ///< what is being solved is interrupted; keyframes that wait are still inserted
};

/// Puts mapper and loop closer somewhere: into the caller's thread, or into threads of their own.
///
/// What they throw is a failure: the map stays as it was published last, the rest is dropped, and
/// every call tells the failure.
class MappingRunner {
 public:
  virtual ~MappingRunner() = default;
  /// Hands over a candidate. False if the mapper is too far behind to take it. A candidate that
  /// starts a map is always taken, and the map is there when the call returns.
  virtual Result<bool> submit(KeyFrameCandidate candidate) = 0;
  /// No candidate waits or is being worked on.
  virtual bool idle() const = 0;
  /// Returns when every candidate of a frame before `stamp` has been worked off, or nobody will.
  virtual void wait_for_frames_before(Timestamp stamp) = 0;
  /// The newest published map; never null.
  virtual std::shared_ptr<const Atlas> atlas() const = 0;
  /// What went wrong so far.
  virtual Result<void> failure() const = 0;
  /// Stops. Further candidates are refused.
  virtual Result<void> finish(Ending ending) = 0;
  /// Complete after `finish`.
  virtual MappingReports reports() const = 0;
};

/// Mapper and loop closer in the caller's thread: deterministic.
std::unique_ptr<MappingRunner> make_inline_mapping(Mapper mapper, const LoopOptions& options);
/// Mapper, loop closer and full bundles in a thread each. @throws std::system_error if there is no
/// thread to be had.
std::unique_ptr<MappingRunner> make_threaded_mapping(Mapper mapper, const LoopOptions& options);

}  // namespace ydd
