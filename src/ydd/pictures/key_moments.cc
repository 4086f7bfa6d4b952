// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/key_moments.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ydd/image/jpeg_codec.h"
#include "ydd/pictures/loop_picture.h"

namespace ydd {
namespace {

constexpr std::size_t kPerKind = 3;
constexpr std::int64_t kApart_ns = 2'000'000'000;  // two peaks closer than this are one
constexpr int kQuality = 82;

double rejected_share(const FilteredFeatures& filtered) {
  return filtered.extracted() == 0 ? 0
                                   : static_cast<double>(filtered.rejected.size()) /
                                         static_cast<double>(filtered.extracted());
}

/// Drift says how much a loop mattered.
std::vector<LoopReport> largest(std::vector<LoopReport> loops) {
  std::stable_sort(loops.begin(), loops.end(),
                   [](const LoopReport& a, const LoopReport& b) { return a.shift_m > b.shift_m; });
  loops.resize(std::min(loops.size(), kPerKind));
  return loops;
}

std::string caption_of(const LoopReport& loop) {
  return fmt::format("Frame {}: {} frame {} ({} points, had drifted by {:.1f} cm)",
                     loop.current_frame, loop.merged ? "map joined at" : "loop closed with",
                     loop.matched_frame, loop.inliers, 100 * loop.shift_m);
}

}  // namespace

KeyMoments::Kept KeyMoments::keep(const RgbdFrame& frame, const FrameReport& report,
                                  std::string caption, double weight) {
  return {frame.colour, report, std::move(caption), weight};
}

void KeyMoments::add(const RgbdFrame& frame, const FrameReport& report) {
  add_peak(frame, report);
  add_change(frame, report);
}

void KeyMoments::add_peak(const RgbdFrame& frame, const FrameReport& report) {
  const double share = rejected_share(*report.filtered);
  if (share <= 0) return;
  const auto make = [&] {
    return keep(frame, report,
                fmt::format("Frame {}: {:.0f} % of {} points rejected", report.index, 100 * share,
                            report.filtered->extracted()),
                share);
  };
  const auto near = std::find_if(peaks_.begin(), peaks_.end(), [&](const Kept& peak) {
    return report.stamp.ns - peak.report.stamp.ns < kApart_ns;
  });
  if (near != peaks_.end()) {
    if (share > near->weight) *near = make();
    return;
  }
  if (peaks_.size() < kPerKind) {
    peaks_.push_back(make());
    return;
  }
  const auto least =
      std::min_element(peaks_.begin(), peaks_.end(),
                       [](const Kept& a, const Kept& b) { return a.weight < b.weight; });
  if (share <= least->weight) return;
  peaks_.erase(least);  // the newest stays last
  peaks_.push_back(make());
}

void KeyMoments::add_change(const RgbdFrame& frame, const FrameReport& report) {
  const TrackingState before = std::exchange(state_, report.track.state);
  if (before == TrackingState::tracking && state_ == TrackingState::lost &&
      lost_.size() < kPerKind) {
    lost_.push_back(keep(frame, report, fmt::format("Frame {}: lost", report.index), 0));
  }
  if (before == TrackingState::lost && state_ == TrackingState::tracking &&
      found_.size() < kPerKind) {
    // A frame that starts a map has no local map to agree with.
    const char* const how = report.track.local_points > 0 ? "found again" : "a new map begins";
    const std::int64_t missed = report.index - last_tracked_ - 1;
    found_.push_back(keep(frame, report,
                          fmt::format("Frame {}: {} after {} frame{}", report.index, how, missed,
                                      missed == 1 ? "" : "s"),
                          0));
  }
  if (state_ == TrackingState::tracking) last_tracked_ = report.index;
}

std::vector<FrameMoment> KeyMoments::draw(const ObjectCatalogue& catalogue,
                                          const std::vector<LoopReport>& loops, const Atlas& atlas,
                                          const ReadColour& read_colour) const {
  std::vector<FrameMoment> out;
  const auto add = [&](std::int64_t frame, const char* kind, const std::string& caption,
                       const ColourImage& picture, bool wide) {
    if (picture.empty()) return;
    Result<std::string> jpeg = encode_jpeg(picture, kQuality);
    if (jpeg) out.push_back({frame, kind, {caption, *std::move(jpeg), wide}});
  };
  const auto add_all = [&](const std::vector<Kept>& moments, const char* kind) {
    for (const Kept& kept : moments) {
      RgbdFrame frame;
      frame.colour = kept.colour;
      add(kept.report.index, kind, kept.caption, annotate(frame, kept.report, catalogue), false);
    }
  };
  add_all(peaks_, "most_rejected");
  add_all(lost_, "lost");
  add_all(found_, "found");
  for (const LoopReport& loop : largest(loops)) {
    const auto current = read_colour(loop.current_frame);
    const auto matched = read_colour(loop.matched_frame);
    if (!current || !matched) continue;
    add(loop.current_frame, "loop", caption_of(loop), loop_picture(loop, atlas, *matched, *current),
        true);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const FrameMoment& a, const FrameMoment& b) { return a.frame < b.frame; });
  return out;
}

}  // namespace ydd
