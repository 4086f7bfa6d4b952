// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/repeated_pictures.h"

#include <algorithm>
#include <functional>

namespace ydd {
namespace {

constexpr int kHarmlessRepeats = 2;

template <class Pixel>
std::size_t pixels_in(const Image<Pixel>& image) {
  return static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height());
}

template <class Pixel>
bool same_pixels(const Image<Pixel>& a, const Image<Pixel>& b) {
  return !a.empty() && a.width() == b.width() && a.height() == b.height() &&
         std::equal(a.data(), a.data() + pixels_in(a), b.data());
}

/// A depth image of one value says nothing of time.
bool is_flat(const DepthImage& depth_m) {
  const float* const end = depth_m.data() + pixels_in(depth_m);
  return std::adjacent_find(depth_m.data(), end, std::not_equal_to<>()) == end;
}

}  // namespace

RepeatedPictures::Verdict RepeatedPictures::look(const RgbdFrame& frame) {
  const bool same_colour = same_pixels(frame.colour, colour_);
  const bool same_depth = same_pixels(frame.depth_m, depth_m_);
  // Both: a frame that was sent twice, from which nothing follows.
  const bool depth_stands = same_depth && !same_colour && !is_flat(frame.depth_m);
  depth_repeats_ = depth_stands ? depth_repeats_ + 1 : 0;
  colour_repeats_ = same_colour && !same_depth ? colour_repeats_ + 1 : 0;
  colour_ = frame.colour;
  depth_m_ = frame.depth_m;
  Verdict verdict{depth_repeats_ + colour_repeats_ > 0, ""};
  if (depth_repeats_ > kHarmlessRepeats) verdict.doubt = "the depth image stands still";
  if (colour_repeats_ > kHarmlessRepeats) verdict.doubt = "the colour image stands still";
  return verdict;
}

}  // namespace ydd
