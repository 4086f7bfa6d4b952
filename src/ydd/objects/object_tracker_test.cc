// SPDX-License-Identifier: Apache-2.0
#include "ydd/objects/object_tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

Box box_at(float x) { return {x, 100, x + 100, 300}; }

void update(ObjectTracker& tracker, const std::vector<Box>& boxes,
            const TrackOptions& options = {}) {
  tracker.update(boxes, 640, 480, options);
}

TEST(Associate, MostOverlapComesFirst) {
  EXPECT_THAT(associate(std::vector{box_at(160), box_at(131)}, std::vector{box_at(130)}, 0.3),
              ElementsAre(-1, 0));
}

TEST(Associate, TakesNoneThatOverlapsTooLittleOrIsForbidden) {
  const std::vector boxes{box_at(100)};
  EXPECT_THAT(associate(boxes, std::vector{box_at(190)}, 0.3), ElementsAre(-1));
  EXPECT_THAT(associate(boxes, boxes, 0.3, [](std::size_t, std::size_t) { return false; }),
              ElementsAre(-1));
}

TEST(ObjectTracker, AnObjectKeepsItsNumber) {
  ObjectTracker tracker;
  update(tracker, {box_at(100), box_at(400)});
  update(tracker, {box_at(395), box_at(108)});
  ASSERT_THAT(tracker.tracks(), SizeIs(2));
  EXPECT_EQ(tracker.tracks()[0].id, 1);
  EXPECT_EQ(tracker.tracks()[1].id, 0);
  EXPECT_EQ(tracker.tracks()[1].seen, 2);
  EXPECT_FLOAT_EQ(tracker.tracks()[1].dx_px, 8);
}

TEST(ObjectTracker, ANumberIsNeverGivenTwice) {
  ObjectTracker tracker;
  update(tracker, {box_at(100)});
  update(tracker, {});
  EXPECT_THAT(tracker.tracks(), IsEmpty()) << "seen once: not carried on";
  update(tracker, {box_at(100)});
  EXPECT_EQ(tracker.tracks()[0].id, 1);
  tracker.clear();
  update(tracker, {box_at(100)});
  EXPECT_EQ(tracker.tracks()[0].id, 2);
}

TEST(ObjectTracker, OneThatIsMissedMovesOnAndComesBackAsItself) {
  ObjectTracker tracker;
  for (int i = 0; i < 3; ++i) update(tracker, {box_at(100 + 10 * static_cast<float>(i))});
  update(tracker, {});
  ASSERT_THAT(tracker.tracks(), SizeIs(1));
  EXPECT_EQ(tracker.tracks()[0].found, -1);
  EXPECT_EQ(tracker.tracks()[0].missed, 1);
  EXPECT_EQ(tracker.tracks()[0].box, box_at(130));
  update(tracker, {box_at(139)});
  EXPECT_EQ(tracker.tracks()[0].id, 0);
  EXPECT_EQ(tracker.tracks()[0].missed, 0);
  EXPECT_FLOAT_EQ(tracker.tracks()[0].dx_px, 10) << "where it was carried to is no measurement";
}

TEST(ObjectTracker, OneThatIsMissedTooLongEnds) {
  ObjectTracker tracker;
  const TrackOptions options{.missed = 2};
  for (int i = 0; i < 3; ++i) update(tracker, {box_at(100)}, options);
  for (int i = 0; i < 2; ++i) update(tracker, {}, options);
  EXPECT_THAT(tracker.tracks(), SizeIs(1));
  update(tracker, {}, options);
  EXPECT_THAT(tracker.tracks(), IsEmpty());
}

}  // namespace
}  // namespace ydd
