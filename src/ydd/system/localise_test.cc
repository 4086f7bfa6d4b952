// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/localise.h"

#include <gtest/gtest.h>

#include "ydd/map/map_dump.h"
#include "ydd/system/picture_testing.h"
#include "ydd/system/slam_system.h"

namespace ydd {
namespace {

using testing_world::Wall;

SystemOptions localise_options() {
  SystemOptions options;
  options.deterministic = true;
  options.dynamics.variant = Variant::off;
  return options;
}

class Localise : public testing::Test {
 protected:
  void SetUp() override {
    SlamSystem system(wall_.camera(), localise_options(), ObjectCatalogue::defaults(), nullptr);
    for (int i = 0; i < 40; ++i) ASSERT_TRUE(system.process(wall_.frame(i)).ok());
    ASSERT_TRUE(system.finish());
    atlas_ = system.atlas();
  }
  Wall wall_{60};
  std::shared_ptr<const Atlas> atlas_;
};

TEST_F(Localise, FindsWhereAPictureWasTakenAndLeavesTheMap) {
  const std::string before = dump_map(*atlas_);
  for (const int i : {0, 17, 45}) {
    const auto found = localise(*atlas_, wall_.frame(i), localise_options());
    ASSERT_TRUE(found) << i;
    const SE3 error = wall_.T_world_camera(i).inverse() * found->T_world_camera;
    EXPECT_LT(error.translation().norm(), 0.03) << i;
    EXPECT_GT(found->inliers, 20) << i;
    EXPECT_EQ(found->map, atlas_->map_of(atlas_->newest_keyframe()));
  }
  EXPECT_EQ(dump_map(*atlas_), before);
}

TEST_F(Localise, KnowsNothingOfAnotherPlace) {
  const Wall elsewhere(20, 2, 7);
  EXPECT_FALSE(localise(*atlas_, elsewhere.frame(3), localise_options()));
}

}  // namespace
}  // namespace ydd
