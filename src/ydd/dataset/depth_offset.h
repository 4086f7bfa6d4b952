// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/image/image.h"

namespace ydd {

/// How well a depth image lies over a grey one: the mean brightness step across the edges of depth,
/// over the mean step everywhere. Things end in depth where they end in brightness, so it is
/// largest when both were taken at once. Nothing where depth has too few edges.
std::optional<double> edge_agreement(const GreyImage& grey, const RawDepthImage& depth);

/// Reads one image of a list.
struct PictureReaders {
  std::function<Result<GreyImage>(std::size_t)> colour;
  std::function<Result<RawDepthImage>(std::size_t)> depth;
};

/// Seconds to add to the stamps of the depth images so that they fit the colour images best, from
/// the pictures themselves: some colour images are laid over the depth images within a quarter of a
/// second of each. 0 when no other depth image fits clearly better than the nearest in time. Fails
/// when a picture cannot be read, and when depth shows no edges or the camera stands still.
/// @throws std::logic_error unless both lists are increasing and not empty.
Result<double> estimate_depth_offset_s(std::span<const Timestamp> colour,
                                       std::span<const Timestamp> depth,
                                       const PictureReaders& read);

}  // namespace ydd
