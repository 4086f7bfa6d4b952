// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/letterbox.h"

#include <cstddef>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ydd {
namespace {

ColourImage filled(int width_px, int height_px, Bgr colour) {
  return {width_px, height_px,
          std::vector<Bgr>(static_cast<std::size_t>(width_px) * height_px, colour)};
}

float at(const Tensor& t, int channel, int x, int y) {
  return t.values[(static_cast<std::size_t>(channel) * t.shape[2] + y) * t.shape[3] + x];
}

TEST(Letterbox, KeepsTheShapeAndCentres) {
  const Letterbox same = letterbox_for(640, 480, 640, 480);
  EXPECT_EQ(same, (Letterbox{1.0F, 0, 0, 640, 480}));
  const Letterbox half = letterbox_for(640, 480, 320, 256);
  EXPECT_EQ(half, (Letterbox{0.5F, 0, 8, 320, 240}));
  const Letterbox tall = letterbox_for(480, 640, 640, 640);
  EXPECT_EQ(tall, (Letterbox{1.0F, 80, 0, 480, 640}));
  const Letterbox enlarged = letterbox_for(320, 240, 640, 512);
  EXPECT_EQ(enlarged, (Letterbox{2.0F, 0, 16, 640, 480}));
  EXPECT_GE(letterbox_for(10000, 3, 320, 256).height_px, 1);
  EXPECT_THROW(letterbox_for(0, 480, 320, 256), std::logic_error);
}

TEST(Letterbox, BoxesReturnToImagePixels) {
  const Letterbox half = letterbox_for(640, 480, 320, 256);
  EXPECT_EQ(to_image({0, 8, 320, 248}, half), (Box{0, 0, 640, 480}));
  EXPECT_EQ(to_image({10, 20, 30, 40}, half), (Box{20, 24, 60, 64}));
}

TEST(Letterboxer, OrdersAndScalesChannels) {
  const ColourImage image = filled(64, 32, {10, 20, 255});
  Letterboxer unit({64, 32, true, 1.0F / 255});
  const Tensor rgb = unit.prepare(image);
  EXPECT_EQ(rgb.shape, (std::vector<int>{1, 3, 32, 64}));
  EXPECT_FLOAT_EQ(at(rgb, 0, 5, 5), 1.0F);
  EXPECT_FLOAT_EQ(at(rgb, 1, 63, 31), 20.0F / 255);
  EXPECT_FLOAT_EQ(at(rgb, 2, 0, 0), 10.0F / 255);
  Letterboxer byte({64, 32, false, 1.0F});
  const Tensor bgr = byte.prepare(image);
  EXPECT_FLOAT_EQ(at(bgr, 0, 5, 5), 10.0F);
  EXPECT_FLOAT_EQ(at(bgr, 2, 5, 5), 255.0F);
}

TEST(Letterboxer, PutsEachPixelInItsPlace) {
  std::vector<Bgr> pixels(64 * 32);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = {static_cast<std::uint8_t>(i % 64), static_cast<std::uint8_t>(i / 64), 7};
  }
  Letterboxer letterboxer({64, 64, false, 1.0F});
  const Tensor t = letterboxer.prepare({64, 32, pixels});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool inside = y >= 16 && y < 48;
      ASSERT_EQ(at(t, 0, x, y), inside ? static_cast<float>(x) : 114.0F) << x << ' ' << y;
      ASSERT_EQ(at(t, 1, x, y), inside ? static_cast<float>(y - 16) : 114.0F) << x << ' ' << y;
    }
  }
}

TEST(Letterboxer, AveragesWhenItShrinks) {
  // Columns alternate between 0 and 200: at a quarter of the size every pixel is their mean.
  std::vector<Bgr> pixels(128 * 128);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto v = static_cast<std::uint8_t>(i % 2 == 0 ? 0 : 200);
    pixels[i] = {v, v, v};
  }
  Letterboxer letterboxer({32, 32, false, 1.0F});
  const Tensor t = letterboxer.prepare({128, 128, pixels});
  for (const float v : t.values) ASSERT_NEAR(v, 100.0F, 1.0F);
}

TEST(Letterboxer, AnImageOfAnotherShapeLeavesNothingOfTheOneBefore) {
  Letterboxer letterboxer({64, 64, false, 1.0F});
  letterboxer.prepare(filled(64, 64, {1, 1, 1}));
  const Tensor t = letterboxer.prepare(filled(64, 32, {2, 2, 2}));
  EXPECT_EQ(at(t, 0, 10, 0), 114.0F);
  EXPECT_EQ(at(t, 0, 10, 63), 114.0F);
  EXPECT_EQ(at(t, 0, 10, 32), 2.0F);
}

}  // namespace
}  // namespace ydd
