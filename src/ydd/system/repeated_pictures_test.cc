// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/repeated_pictures.h"

#include <gtest/gtest.h>

#include "ydd/system/picture_testing.h"

namespace ydd {
namespace {

using testing_world::Wall;

/// The wall with a depth image that is not the same everywhere.
RgbdFrame frame(const Wall& wall, int colour, int depth) {
  RgbdFrame out = wall.frame(colour);
  std::vector<float> depth_m(320U * 240U, 2.0F);
  depth_m[static_cast<std::size_t>(depth)] = 1.0F;
  out.depth_m = DepthImage(320, 240, std::move(depth_m));
  return out;
}

TEST(RepeatedPictures, DepthThatStandsStillIsDoubtedAfterTwoRepeats) {
  const Wall wall(10);
  RepeatedPictures pictures;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(pictures.look(frame(wall, i, 7)).doubt, "") << i;
  EXPECT_EQ(pictures.look(frame(wall, 3, 7)).doubt, "the depth image stands still");
  EXPECT_EQ(pictures.look(frame(wall, 4, 8)).doubt, "");
}

TEST(RepeatedPictures, ASlowerDepthCameraIsFineButNoRepeatIsKept) {
  const Wall wall(10);
  RepeatedPictures pictures;
  for (int i = 0; i < 9; ++i) {
    const RepeatedPictures::Verdict verdict = pictures.look(frame(wall, i, i / 3));
    EXPECT_EQ(verdict.doubt, "") << i;
    EXPECT_EQ(verdict.stale, i % 3 != 0) << i;
  }
}

TEST(RepeatedPictures, ColourThatStandsStillToo) {
  const Wall wall(10);
  RepeatedPictures pictures;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(pictures.look(frame(wall, 0, i)).doubt, "") << i;
  EXPECT_EQ(pictures.look(frame(wall, 0, 3)).doubt, "the colour image stands still");
}

TEST(RepeatedPictures, NothingFollowsFromAWholeFrameSentAgainOrAFlatDepth) {
  const Wall wall(10);
  RepeatedPictures pictures;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(pictures.look(frame(wall, 0, 7)).doubt, "") << i;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(pictures.look(wall.frame(i)).doubt, "") << i;
}

}  // namespace
}  // namespace ydd
