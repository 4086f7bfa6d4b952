// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/draw.h"

#include <algorithm>
#include <cstddef>

#include <gtest/gtest.h>

namespace ydd {
namespace {

ColourImage black(int width_px, int height_px) {
  return {width_px, height_px, std::vector<Bgr>(static_cast<std::size_t>(width_px) * height_px)};
}

TEST(DrawDetections, ColoursBoxesByCategoryAndLeavesTheImageAlone) {
  const ColourImage image = black(200, 150);
  const ColourImage drawn = draw_detections(image,
                                            {{"person", 0.9F, {20, 40, 80, 140}},
                                             {"cup", 0.8F, {100, 40, 120, 60}},
                                             {"wall", 0.7F, {140, 40, 190, 140}}},
                                            ObjectCatalogue::defaults());
  EXPECT_EQ(drawn(20, 100), colour_of(Category::dynamic));
  EXPECT_EQ(drawn(50, 90), colour_of(Category::dynamic)) << "the cross at the person's centre";
  EXPECT_EQ(drawn(100, 50), colour_of(Category::potentially_dynamic));
  EXPECT_EQ(drawn(110, 50), (Bgr{})) << "no cross on objects";
  EXPECT_EQ(drawn(140, 100), colour_of(Category::stationary));
  EXPECT_EQ(drawn(165, 90), (Bgr{}));
  const std::size_t count = std::size_t{200} * 150;
  EXPECT_TRUE(
      std::all_of(image.data(), image.data() + count, [](const Bgr& p) { return p == Bgr{}; }));
}

TEST(DrawDetections, WhatIsNotSureHasAThinLine) {
  const auto widest = [](bool sure) {
    Detections one = {{"chair", 0.5F, {20, 40, 80, 140}}};
    one[0].sure = sure;
    const ColourImage drawn = draw_detections(black(200, 150), one, ObjectCatalogue::defaults());
    int width_px = 0;
    for (int x = 10; x < 30; ++x) width_px += drawn(x, 100) == Bgr{} ? 0 : 1;
    return width_px;
  };
  EXPECT_EQ(widest(false), 1);
  EXPECT_GT(widest(true), 1);
}

TEST(DrawDetections, CutsOffWhatLeavesTheImage) {
  const Detections outside = {{"person", 1.0F, {-50, -50, 300, 300}},
                              {"head", 1.0F, {90, 0, 100, 10}},
                              {"hand", 1.0F, {500, 500, 600, 600}}};
  const ColourImage drawn = draw_detections(black(100, 80), outside, ObjectCatalogue::defaults());
  EXPECT_EQ(drawn.width(), 100);
  EXPECT_EQ(drawn.height(), 80);
  EXPECT_TRUE(draw_detections({}, outside, ObjectCatalogue::defaults()).empty());
}

}  // namespace
}  // namespace ydd
