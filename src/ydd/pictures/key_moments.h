// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/pictures/annotate.h"
#include "ydd/report/html_report.h"

namespace ydd {

/// A key moment with the frame that it is about.
struct FrameMoment {
  std::int64_t frame = 0;
  std::string kind;  ///< most_rejected | lost | found | loop
  KeyMoment moment;
};

/// Picks the frames of a run that are worth looking at: those of which most was rejected, where the
/// camera was lost, where it was found again, and loops. Holds at most nine pictures, drawn only at
/// the end: adding a frame costs next to nothing.
///
/// Thread: one.
class KeyMoments {
 public:
  void add(const RgbdFrame& frame, const FrameReport& report);

  /// Reads the colour image of a frame again.
  using ReadColour = std::function<Result<ColourImage>(std::int64_t frame)>;

  /// All of them in the order of frames, at most twelve. `loops` are drawn from the keyframes in
  /// `atlas`, both frames side by side; a frame that cannot be read any more is left out.
  std::vector<FrameMoment> draw(const ObjectCatalogue& catalogue,
                                const std::vector<LoopReport>& loops, const Atlas& atlas,
                                const ReadColour& read_colour) const;

 private:
  struct Kept {
    ColourImage colour;
    FrameReport report;
    std::string caption;
    double weight = 0;  ///< of two moments of a kind the heavier one stays
  };
  static Kept keep(const RgbdFrame& frame, const FrameReport& report, std::string caption,
                   double weight);
  void add_peak(const RgbdFrame& frame, const FrameReport& report);
  void add_change(const RgbdFrame& frame, const FrameReport& report);

  std::vector<Kept> peaks_, lost_, found_;
  TrackingState state_ = TrackingState::initializing;
  std::int64_t last_tracked_ = -1;
};

}  // namespace ydd
