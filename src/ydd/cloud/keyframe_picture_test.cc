// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/keyframe_picture.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr Box kPerson = {60, 30, 100, 110};

/// A white wall at 3 m; before it, a red person at 1.5 m who fills an ellipse of the box.
PictureSource person_before_a_wall(std::optional<DepthRange> range) {
  std::vector<Bgr> colour;
  std::vector<float> depth_m;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float dx = (static_cast<float>(x) - 80.0F) / 20.0F;
      const float dy = (static_cast<float>(y) - 70.0F) / 40.0F;
      const bool person = dx * dx + dy * dy < 1.0F;
      colour.push_back(person ? Bgr{0, 0, 255} : Bgr{255, 255, 255});
      depth_m.push_back(person ? 1.5F : 3.0F);
    }
  }
  PictureSource source{ColourImage(kWidth, kHeight, std::move(colour)),
                       DepthImage(kWidth, kHeight, std::move(depth_m)),
                       {}};
  source.moving.push_back({0, Rule::body_depth, kPerson, range});
  return source;
}

OpenPicture reopened(const PictureSource& source) {
  return open_keyframe_picture(make_keyframe_picture(source)).value();
}

/// Pixels that have depth below 2 m, and pixels that look red.
std::pair<int, int> traces_of_the_person(const OpenPicture& picture) {
  int near = 0;
  int red = 0;
  for (int y = 0; y < picture.depth_mm.height(); ++y) {
    for (int x = 0; x < picture.depth_mm.width(); ++x) {
      const Bgr& c = picture.colour(x, y);
      near += picture.depth_mm(x, y) > 0 && picture.depth_mm(x, y) < 2000 ? 1 : 0;
      red += c[2] > c[0] + 40 ? 1 : 0;
    }
  }
  return {near, red};
}

TEST(KeyframePicture, KeepsTheSceneAtHalfSize) {
  PictureSource source = person_before_a_wall({});
  source.moving.clear();
  const OpenPicture picture = reopened(source);
  EXPECT_EQ(picture.depth_mm.width(), kWidth / 2);
  EXPECT_EQ(picture.depth_mm.height(), kHeight / 2);
  EXPECT_EQ(picture.depth_mm(3, 3), 3000);
  EXPECT_EQ(picture.depth_mm(40, 35), 1500);
  EXPECT_GT(picture.colour(3, 3)[0], 245);
  EXPECT_GT(traces_of_the_person(picture).first, 500);
  EXPECT_GT(traces_of_the_person(picture).second, 500);
}

TEST(KeyframePicture, NoPixelOfAPersonIsLeftButTheWallBehindIs) {
  const OpenPicture picture = reopened(person_before_a_wall(DepthRange{1.2F, 1.8F}));
  EXPECT_EQ(traces_of_the_person(picture), (std::pair{0, 0}));
  EXPECT_EQ(picture.depth_mm(30, 15), 3000);  // in the box, in a corner that the person leaves free
  EXPECT_EQ(picture.depth_mm(3, 3), 3000);
}

TEST(KeyframePicture, WhatWasSeenToMoveGoesWithoutABox) {
  PictureSource source = person_before_a_wall({});
  source.moving.clear();
  MotionOdds odds;
  odds.depth = coarse_depth(source.depth_m, 8);
  for (const float z_m : odds.depth.z_m) odds.moves.push_back(z_m < 2.0F);
  odds.log_odds.assign(odds.moves.size(), 0.0F);
  source.odds = std::make_shared<const MotionOdds>(odds);
  const OpenPicture picture = reopened(source);
  EXPECT_EQ(traces_of_the_person(picture), (std::pair{0, 0}));
  EXPECT_EQ(picture.depth_mm(3, 3), 3000);
  EXPECT_EQ(picture.depth_mm(70, 35), 3000);
}

TEST(KeyframePicture, OfAMaskNothingElseOfTheBoxGoes) {
  PictureSource source = person_before_a_wall({});
  std::vector<std::uint8_t> mask;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) mask.push_back(source.depth_m(x, y) < 2.0F);
  }
  source.moving.front().mask = GreyImage(kWidth, kHeight, std::move(mask));
  const OpenPicture picture = reopened(source);
  EXPECT_EQ(traces_of_the_person(picture), (std::pair{0, 0}));
  EXPECT_EQ(picture.depth_mm(31, 16), 3000);  // in the box
}

TEST(KeyframePicture, OfAPersonTheWholeBoxGoesAndThatIsNoted) {
  PictureSource source = person_before_a_wall(DepthRange{1.2F, 1.8F});
  EXPECT_FALSE(people_left_out(make_keyframe_picture(source)));
  source.looked = true;  // and nobody was found, however it moves
  EXPECT_TRUE(people_left_out(make_keyframe_picture(source)));
  EXPECT_EQ(reopened(source).depth_mm(30, 15), 3000);
  source.moving.clear();  // a person who stands still
  source.people = {{60, 30, 100, 110}};
  const OpenPicture picture = reopened(source);
  EXPECT_EQ(traces_of_the_person(picture), (std::pair{0, 0}));
  EXPECT_EQ(picture.depth_mm(30, 15), 0) << "in the box, behind the person";
  EXPECT_EQ(picture.depth_mm(3, 3), 3000);
}

TEST(KeyframePicture, WithoutARangeTheWholeBoxGoes) {
  const OpenPicture picture = reopened(person_before_a_wall({}));
  EXPECT_EQ(traces_of_the_person(picture), (std::pair{0, 0}));
  EXPECT_EQ(picture.depth_mm(31, 15), 0);
  EXPECT_EQ(picture.depth_mm(3, 3), 3000);
}

TEST(KeyframePicture, ABoxThatIsAFewPixelsOffLeavesNothingEither) {
  PictureSource source = person_before_a_wall(DepthRange{1.2F, 1.8F});
  source.moving[0].box = {66, 36, 106, 116};
  EXPECT_EQ(traces_of_the_person(reopened(source)), (std::pair{0, 0}));
  source.moving[0].box = {54, 24, 94, 104};
  EXPECT_EQ(traces_of_the_person(reopened(source)), (std::pair{0, 0}));
}

TEST(KeyframePicture, NoDepthBetweenTwoSurfaces) {
  std::vector<float> depth_m;
  for (int i = 0; i < 8 * 4; ++i) depth_m.push_back(i % 8 < 3 ? 1.0F : 2.0F);
  const PictureSource source{
      ColourImage(8, 4, std::vector<Bgr>(32)), DepthImage(8, 4, std::move(depth_m)), {}};
  const OpenPicture picture = reopened(source);
  EXPECT_EQ(picture.depth_mm(0, 0), 1000);
  EXPECT_EQ(picture.depth_mm(1, 0), 0);  // columns 2 and 3
  EXPECT_EQ(picture.depth_mm(2, 0), 2000);
}

TEST(KeyframePicture, DamageIsAFailure) {
  const KeyFramePicture good = make_keyframe_picture(person_before_a_wall({}));
  KeyFramePicture bad = good;
  bad.width_px = 1000;
  EXPECT_FALSE(open_keyframe_picture(bad).ok());
  bad = good;
  bad.depth_png.resize(bad.depth_png.size() / 2);
  EXPECT_FALSE(open_keyframe_picture(bad).ok());
  bad = good;
  std::swap(bad.depth_png, bad.colour_jpeg);
  EXPECT_FALSE(open_keyframe_picture(bad).ok());
}

}  // namespace
}  // namespace ydd
