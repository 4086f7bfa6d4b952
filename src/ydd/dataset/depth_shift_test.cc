// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/depth_shift.h"

#include <array>
#include <random>

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr int kWidth = 320, kHeight = 240;

/// Boxes of random brightness before a wall; depth lies `shift` off colour. Unless `told` colour
/// shows none of them.
LaidPair boxes(unsigned seed, const DepthShift& shift, bool told = true) {
  std::mt19937 random(seed);
  const auto between = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  std::vector<std::uint8_t> grey(static_cast<std::size_t>(kWidth) * kHeight);
  for (std::uint8_t& g : grey) g = static_cast<std::uint8_t>(90 + between(-8, 8));
  std::vector<std::uint16_t> depth(grey.size(), 3000);
  for (int box = 0; box < 12; ++box) {
    const int x0 = between(30, kWidth - 80), y0 = between(30, kHeight - 70);
    const int w = between(15, 40), h = between(15, 40), z = between(800, 1500);
    const int bright = told ? between(150, 220) : 90;
    for (int y = y0; y < y0 + h; ++y) {
      for (int x = x0; x < x0 + w; ++x) {
        if (told) {
          grey[static_cast<std::size_t>(y) * kWidth + x] =
              static_cast<std::uint8_t>(bright + between(-8, 8));
        }
        depth[static_cast<std::size_t>(y + shift.down_px) * kWidth + x + shift.right_px] =
            static_cast<std::uint16_t>(z);
      }
    }
  }
  return {GreyImage(kWidth, kHeight, std::move(grey)),
          RawDepthImage(kWidth, kHeight, std::move(depth))};
}

DepthShift estimated(const DepthShift& shift, bool told = true, unsigned pairs = 20) {
  return estimate_depth_shift(pairs, [&](std::size_t i) -> Result<LaidPair> {
    return boxes(static_cast<unsigned>(i) + 1, shift, told);
  });
}

TEST(DepthShift, IsFoundInEveryDirection) {
  for (const DepthShift shift : {DepthShift{3, 0}, {-4, 0}, {0, 3}, {0, -5}, {4, -3}}) {
    EXPECT_EQ(estimated(shift), shift) << shift.right_px << "," << shift.down_px;
  }
}

TEST(DepthShift, WhatLiesInPlaceIsLeft) {
  EXPECT_TRUE(estimated({}).none());
  EXPECT_TRUE(estimated({1, -1}).none());  // every real sensor
}

TEST(DepthShift, NothingIsSaidWhereThePicturesDoNotTell) {
  EXPECT_TRUE(estimated({4, 0}, false).none());    // edges of depth that colour does not show
  EXPECT_TRUE(estimated({4, 0}, true, 3).none());  // too few pairs
}

TEST(DepthShift, PairsThatCannotBeReadArePassedOver) {
  const auto read = [](std::size_t i) -> Result<LaidPair> {
    if (i % 3 == 0) return Error{"broken"};
    return boxes(static_cast<unsigned>(i), {4, 0});
  };
  EXPECT_EQ(estimate_depth_shift(16, read), (DepthShift{4, 0}));
  EXPECT_TRUE(estimate_depth_shift(0, read).none());
}

TEST(DepthShift, IsParsed) {
  EXPECT_EQ(parse_depth_shift("3,-2").value(), (DepthShift{3, -2}));
  for (const char* wrong : {"", "3", "3,", ",3", "3,2,1", "3.5,1", "101,0", "0,-101", "a,b"}) {
    EXPECT_FALSE(parse_depth_shift(wrong).ok()) << wrong;
  }
}

TEST(DepthShift, IsTakenBack) {
  std::vector<float> values;
  for (int i = 0; i < 12; ++i) values.push_back(static_cast<float>(i));
  const DepthImage moved = laid_over(DepthImage(4, 3, std::move(values)), {1, -1});
  EXPECT_EQ(moved(0, 1), 1.0F);  // was at (1, 0)
  EXPECT_EQ(moved(2, 2), 7.0F);  // was at (3, 1)
  EXPECT_EQ(moved(3, 2), 0.0F);  // from outside
  EXPECT_EQ(moved(0, 0), 0.0F);
}

}  // namespace
}  // namespace ydd
