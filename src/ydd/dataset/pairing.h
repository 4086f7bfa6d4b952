// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "ydd/base/timestamp.h"
#include "ydd/dataset/association.h"

namespace ydd {

/// How well the colour and the depth images of a recording found each other.
struct Pairing {
  std::size_t colour_images = 0, depth_images = 0, pairs = 0;
  double depth_offset_s = 0;    ///< that was added to the stamps of the depth images
  double depth_later_s = 0;     ///< median of depth minus colour stamps over the pairs, after that
  bool steadily_late = false;   ///< all pairs differ by about as much, and by much
  double fitting_offset_s = 0;  ///< added to the depth stamps instead, it would pair more images
  std::size_t fitting_pairs = 0;  ///< how many that would be; 0: no such offset
};

/// Judges `pairs` of colour (a) and depth (b) images; both lists are strictly increasing, `depth`
/// with `depth_offset_s` added already.
Pairing judge_pairing(std::span<const Timestamp> colour, std::span<const Timestamp> depth,
                      std::span<const IndexPair> pairs, double max_difference_s,
                      double depth_offset_s = 0);

/// What the user of the recording must know: more than a few in a hundred images without partner,
/// or stamps that are steadily apart. Empty: all is well. Does not name the recording.
std::string pairing_warning(const Pairing& pairing, double max_difference_s);

}  // namespace ydd
