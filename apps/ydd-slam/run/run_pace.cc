// SPDX-License-Identifier: Apache-2.0
#include "run/run_pace.h"

#include <utility>

#include <fmt/format.h>

#include "ydd/base/interruption.h"
#include "ydd/base/timing.h"

namespace ydd::app {
namespace {

/// Longer than people wait for a camera, shorter than any wrong unit or clock makes it.
constexpr double kLongestGap_s = 5.0;
/// Milliseconds that pass for seconds are off by 1000; no camera skips so many frames for long.
constexpr double kWrongUnit = 300.0;

double gap_s(const Sequence& sequence, std::size_t before) {
  return seconds_between(sequence.entry(before).stamp, sequence.entry(before + 1).stamp);
}

}  // namespace

double median_gap_s(const Sequence& sequence) {
  std::vector<double> gaps;
  for (std::size_t i = 0; i + 1 < sequence.size(); ++i) gaps.push_back(gap_s(sequence, i));
  return statistics_of(std::move(gaps)).median;
}

std::vector<std::string> odd_stamps(const Sequence& sequence, double fps) {
  std::vector<std::string> out;
  const double ratio = median_gap_s(sequence) * fps;
  if (ratio > kWrongUnit || (ratio > 0 && ratio < 1 / kWrongUnit)) {
    out.push_back(fmt::format(
        "frames are {:.4g} s apart by their stamps, but the camera takes {:.4g} in a second: are "
        "the stamps in seconds? Times in the options count in them",
        median_gap_s(sequence), fps));
    if (ratio > kWrongUnit) return out;  // then every gap is long
  }
  std::size_t longest = 0;
  int count = 0;
  for (std::size_t i = 0; i + 1 < sequence.size(); ++i) {
    if (gap_s(sequence, i) <= kLongestGap_s) continue;
    if (count == 0 || gap_s(sequence, i) > gap_s(sequence, longest)) longest = i;
    ++count;
  }
  if (count == 0) return out;
  const std::string others = count > 1 ? fmt::format(" ({} such gaps)", count) : "";
  out.push_back(
      fmt::format("frames {} and {} are {:.10g} s apart{}; are the stamps in seconds and "
                  "of one recording?",
                  longest, longest + 1, gap_s(sequence, longest), others));
  return out;
}

Pace::Pace(const Sequence& sequence, double fps) : start_(Clock::now()) {
  const auto nanoseconds = [](double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  };
  const double usual_s = 1 / fps;
  Clock::duration due{};
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    due_.push_back(due);
    if (i + 1 == sequence.size()) break;
    const double gap = gap_s(sequence, i);
    due += nanoseconds(gap > kLongestGap_s ? usual_s : gap);
  }
}

std::size_t Pace::newest_due(std::size_t i) const {
  const Clock::duration now = Clock::now() - start_;
  while (i + 1 < due_.size() && due_[i + 1] <= now) ++i;
  return i;
}

bool Pace::wait_until_due(std::size_t i) const {
  return interruption::sleep_until(start_ + due_.at(i));
}

}  // namespace ydd::app
