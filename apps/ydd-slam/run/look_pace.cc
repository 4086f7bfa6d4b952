// SPDX-License-Identifier: Apache-2.0
#include "run/look_pace.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "run/run_pace.h"
#include "ydd/base/guard.h"
#include "ydd/base/timing.h"
#include "ydd/image/decode.h"

namespace ydd::app {
namespace {

/// How long a look takes does not depend on what is seen.
RgbdFrame grey_picture(const Camera& camera) {
  const std::size_t n = std::size_t(camera.width_px) * std::size_t(camera.height_px);
  ColourImage colour(camera.width_px, camera.height_px, std::vector<Bgr>(n, Bgr{128, 128, 128}));
  GreyImage grey = to_grey(colour);
  return {0,
          {},
          std::move(grey),
          std::move(colour),
          DepthImage(camera.width_px, camera.height_px, std::vector<float>(n))};
}

/// Whether looking keeps up. It shares the interval with nobody on two cores, with tracking on one.
bool keeps_pace(const LookPace& pace, int cores) {
  const double share = cores > 1 ? 0.8 : 0.4;
  return pace.look_ms <= share * pace.interval_ms;
}

}  // namespace

std::optional<LookPace> measure_look(Detector& detector, const Sequence& sequence,
                                     const Camera& camera) {
  if (!sequence.is_live() && sequence.size() < 2) return std::nullopt;
  const Result<RgbdFrame> frame =
      sequence.is_live() ? Result(grey_picture(camera)) : sequence.read(0, camera);
  if (!frame) return std::nullopt;
  LookPace pace{0, 1e3 * (sequence.is_live() ? 1 / camera.fps : median_gap_s(sequence))};
  for (int i = 0; i < 2; ++i) {  // the first may still allocate
    const std::int64_t start_ns = wall_clock_ns();
    if (!guarded("detector", [&] { return detector.detect(*frame); })) return std::nullopt;
    const double took_ms = 1e-6 * static_cast<double>(wall_clock_ns() - start_ns);
    pace.look_ms = i == 0 ? took_ms : std::min(pace.look_ms, took_ms);
  }
  return pace;
}

DetectChoice choose_detect_mode(DetectMode mode, const LookPace& pace, bool realtime, int cores) {
  if (keeps_pace(pace, cores)) return {DetectMode::every_frame, ""};
  const std::string fact = fmt::format("a look takes {:.0f} ms and a picture comes every {:.0f} ms",
                                       pace.look_ms, pace.interval_ms);
  if (realtime && mode == DetectMode::automatic) {
    return {DetectMode::asynchronous,
            fact + ": tracking does not wait for boxes (--detect asynchronous)"};
  }
  if (realtime) {
    return {DetectMode::every_frame,
            fact + ": pictures will be dropped; --detect asynchronous does not wait"};
  }
  return {DetectMode::every_frame,
          fact +
              ": this run is slower than the camera; quicker are --detect asynchronous or smaller "
              "pictures for the network (--detector-set 'networks.*.input.width=320')"};
}

}  // namespace ydd::app
