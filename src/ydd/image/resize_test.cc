// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/resize.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

ColourImage row(std::vector<Bgr> pixels) {
  const int width = static_cast<int>(pixels.size());
  return {width, 1, std::move(pixels)};
}

TEST(Resize, APixelIsTheMeanOfWhatItCovers) {
  const ColourImage half = resized(row({{0, 10, 0}, {2, 30, 0}, {100, 0, 7}, {100, 0, 8}}), 2, 1);
  EXPECT_EQ(half(0, 0), (Bgr{1, 20, 0}));
  EXPECT_EQ(half(1, 0), (Bgr{100, 0, 8}));  // 7.5 is rounded up
  // Three to two: the middle one is shared.
  const ColourImage shared = resized(row({{90, 0, 0}, {60, 0, 0}, {0, 0, 255}}), 2, 1);
  EXPECT_EQ(shared(0, 0), (Bgr{80, 0, 0}));
  EXPECT_EQ(shared(1, 0), (Bgr{20, 0, 170}));
}

TEST(Resize, BothAxes) {
  std::vector<Bgr> pixels;
  for (int i = 0; i < 16; ++i) pixels.push_back({static_cast<std::uint8_t>(i), 255, 0});
  const ColourImage small = resized(ColourImage(4, 4, std::move(pixels)), 2, 2);
  EXPECT_EQ(small(1, 0), (Bgr{5, 255, 0}));   // (2 + 3 + 6 + 7) / 4 = 4.5
  EXPECT_EQ(small(0, 1), (Bgr{11, 255, 0}));  // (8 + 9 + 12 + 13) / 4 = 10.5
  EXPECT_THROW(static_cast<void>(resized(small, 0, 2)), std::logic_error);
}

}  // namespace
}  // namespace ydd
