// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/found_motion.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(FoundMotion, ARigidWorldYieldsNoMover) {
  MoverOptions still;
  still.speed_m_s = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const FoundMotion found = find_motion(still, {}, seed);
    EXPECT_LT(found.false_share, 0.001) << "seed " << seed;
    EXPECT_EQ(found.false_alarms, 0) << "seed " << seed;
    EXPECT_LT(found.found_share, 0.05) << "seed " << seed;
  }
}

struct Mover {
  double side_m, distance_m, speed_m_s;
  int frames;  // within which it must be found
};

class MoversFound : public ::testing::TestWithParam<Mover> {};

TEST_P(MoversFound, WithinTheirTime) {
  const Mover& m = GetParam();
  MoverOptions mover;
  mover.side_m = m.side_m;
  mover.distance_m = m.distance_m;
  mover.speed_m_s = m.speed_m_s;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const FoundMotion found = find_motion(mover, {}, seed);
    EXPECT_GT(found.frames_to_find, 0) << "seed " << seed;
    EXPECT_LE(found.frames_to_find, m.frames) << "seed " << seed;
    EXPECT_LT(found.false_share, 0.03) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, MoversFound,
                         ::testing::Values(Mover{0.3, 1.5, 0.5, 15}, Mover{0.5, 1.8, 1.0, 12},
                                           Mover{0.5, 1.8, 0.2, 25}, Mover{0.8, 1.8, 0.5, 25},
                                           Mover{0.5, 2.5, 0.5, 20}));

TEST(FoundMotion, FollowsFromItsSeed) {
  const FoundMotion once = find_motion({}, {}, 5), again = find_motion({}, {}, 5);
  EXPECT_EQ(once.false_share, again.false_share);
  EXPECT_EQ(once.frames_to_find, again.frames_to_find);
  EXPECT_EQ(once.found_share, again.found_share);
}

}  // namespace
}  // namespace ydd
