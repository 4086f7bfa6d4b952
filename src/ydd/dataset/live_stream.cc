// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/live_stream.h"

#include <utility>

#include <fmt/format.h>

#include "ydd/image/decode.h"

namespace ydd {

Result<RgbdFrame> frame_of(const LivePair& pair, std::int64_t index, const Camera& camera,
                           const DepthShift& shift) {
  const auto has_size = [&](const auto& picture) {
    return picture.width() == camera.width_px && picture.height() == camera.height_px;
  };
  if (!has_size(pair.colour) || !has_size(pair.depth)) {
    return Error{fmt::format(
        "the camera gives {}x{} and depth {}x{} but camera '{}' is {}x{}; give the right one with "
        "--camera, or another --mode",
        pair.colour.width(), pair.colour.height(), pair.depth.width(), pair.depth.height(),
        camera.name, camera.width_px, camera.height_px)};
  }
  DepthImage depth_m = to_metres(pair.depth, camera);
  if (!shift.none()) depth_m = laid_over(depth_m, shift);
  return RgbdFrame{index, pair.stamp, to_grey(pair.colour), pair.colour, std::move(depth_m)};
}

}  // namespace ydd
