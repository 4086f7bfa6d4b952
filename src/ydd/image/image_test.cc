// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/image.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(Image, CopiesShareItsPixels) {
  const GreyImage image(3, 2, {1, 2, 3, 4, 5, 6});
  const GreyImage copy = image;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(copy.data(), image.data());
  EXPECT_EQ(copy(2, 1), 6);
}

TEST(Image, SharesPixelsThatSomebodyElseHolds) {
  const auto pixels = std::make_shared<std::vector<float>>(std::vector<float>{1, 2, 3, 4});
  auto image = DepthImage(2, 2, std::shared_ptr<const float>(pixels, pixels->data()));
  EXPECT_EQ(image.data(), pixels->data());
  EXPECT_EQ(image(0, 1), 3.0F);
  const DepthImage last = image;
  image = {};
  EXPECT_EQ(pixels.use_count(), 2);
  EXPECT_EQ(last(1, 1), 4.0F);
}

TEST(Image, RefusesWhatDoesNotFit) {
  EXPECT_THROW(GreyImage(2, 2, {1, 2, 3}), std::logic_error);
  EXPECT_THROW(GreyImage(2, -2, std::vector<std::uint8_t>()), std::logic_error);
  EXPECT_THROW(GreyImage(2, 2, std::shared_ptr<const std::uint8_t>()), std::logic_error);
  EXPECT_TRUE(GreyImage(0, 0, std::shared_ptr<const std::uint8_t>()).empty());
  EXPECT_EQ(GreyImage().data(), nullptr);
}

}  // namespace
}  // namespace ydd
