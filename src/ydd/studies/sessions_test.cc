// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/sessions.h"

#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"

namespace ydd {
namespace {

WorldOptions small_world() {
  WorldOptions world;
  world.seed = 101;
  world.width_px = 240;
  world.height_px = 180;
  world.fps = 5;
  world.edge_samples = 1;
  world.depth = DepthModel::kinect;
  return world;
}

/// A look at the desks by day, then one in the evening.
Session look_at_desks(int number) {
  Session session;
  session.world = small_world();
  session.world.frames = 20;
  session.world.light = number == 0 ? LightKind::day : LightKind::evening;
  session.path = make_camera_path(session.world).T_world_camera;
  return session;
}

TEST(Sessions, GoOnWithTheMapInOtherLight) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "desks.map";
  SystemOptions options;
  options.deterministic = true;
  const auto first = run_session(look_at_desks, 0, options, file);
  ASSERT_TRUE(first.ok()) << first.error().message;
  const auto second = run_session(look_at_desks, 1, options, file);
  ASSERT_TRUE(second.ok()) << second.error().message;
  EXPECT_EQ(second->light, "evening");
  EXPECT_LE(second->frames_until_found, 2);
  EXPECT_EQ(second->losses, 0);
  EXPECT_EQ(second->maps, 1U);
  EXPECT_LE(second->keyframes, first->keyframes + 2);
  EXPECT_GT(second->place_m, 0.0);
  EXPECT_LT(second->place_m, 0.08);
  EXPECT_EQ(second->misplaced_frames, 0);
}

TEST(Sessions, SayWhenThereIsNoMapToGoOnWith) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "none.map";
  const auto figures = run_session(look_at_desks, 1, {}, file);
  ASSERT_FALSE(figures.ok());
  EXPECT_NE(figures.error().message.find("none.map"), std::string::npos);
}

TEST(Sessions, PlansArePure) {
  VisitOptions visit;
  visit.world = small_world();
  visit.world.path = PathKind::room_loop;
  const SessionPlan plan = visits(visit);
  EXPECT_GT(plan(0).world.frames, plan(1).world.frames);
  EXPECT_EQ(plan(1).world.frames, 40);
  EXPECT_NE(plan(1).world.light, plan(0).world.light);
  EXPECT_NE(plan(1).world.light_seed, plan(5).world.light_seed);
  EXPECT_EQ((plan(3).path(1.0).inverse() * plan(3).path(1.0)).translation().norm(), 0.0);
  EXPECT_GT((plan(3).path(1.0).translation() - plan(4).path(1.0).translation()).norm(), 0.01);
}

TEST(Sessions, AnHourStartsWhereTheLastOneEnded) {
  DayOptions day;
  day.world = small_world();
  day.world.path = PathKind::room_loop;
  day.world.rooms = 2;
  day.session_minutes = 1;
  const SessionPlan plan = hours(day);
  const SE3 apart = plan(0).path(60.0).inverse() * plan(1).path(0.0);
  EXPECT_LT(apart.translation().norm(), 1e-9);
  EXPECT_NE(plan(0).world.chairs_moved_m, plan(1).world.chairs_moved_m);
}

}  // namespace
}  // namespace ydd
