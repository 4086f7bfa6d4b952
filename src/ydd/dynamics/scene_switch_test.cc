// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/scene_switch.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(HasDynamicObject, AsksTheCatalogue) {
  const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  EXPECT_FALSE(has_dynamic_object({}, catalogue));
  EXPECT_FALSE(has_dynamic_object({{"chair", 1, {}}, {"desk", 1, {}}, {"cup", 1, {}}}, catalogue));
  for (const char* name : {"person", "head", "hand", "fan"}) {
    EXPECT_TRUE(has_dynamic_object({{"chair", 1, {}}, {name, 1, {}}}, catalogue)) << name;
  }
}

TEST(SceneSwitch, IsStaticFromTheFifthFrameWithout) {
  SceneSwitch scene(5);
  EXPECT_TRUE(scene.step(true));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(scene.step(false)) << i;
  EXPECT_FALSE(scene.step(false));
  EXPECT_FALSE(scene.step(false));
}

TEST(SceneSwitch, OneDynamicObjectStartsTheCountAgain) {
  SceneSwitch scene(2);
  EXPECT_TRUE(scene.step(false));
  EXPECT_FALSE(scene.step(false));
  EXPECT_TRUE(scene.step(true));
  EXPECT_TRUE(scene.step(false));
  EXPECT_FALSE(scene.step(false));
}

}  // namespace
}  // namespace ydd
