// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/arrival.h"

#include <random>

#include <gtest/gtest.h>

#include "ydd/tracking/tracker_walk_testing.h"

namespace ydd {
namespace {

using testing_world::PointWorld;
using testing_world::Walk;

Timestamp at_s(double s) { return {static_cast<std::int64_t>(1e9 * s)}; }

TEST(Arrival, SettlesWhenThePlaceHasBorneItselfOut) {
  const ArrivalOptions options{1.0, 0.3};
  Arrival arrival(true);
  EXPECT_TRUE(arrival.settled());
  arrival.begin(at_s(10));
  EXPECT_FALSE(arrival.settled());
  EXPECT_TRUE(arrival.look(at_s(10.0), 0.5, options));
  EXPECT_TRUE(arrival.look(at_s(10.5), 0.2, options));  // in the mean it is enough
  EXPECT_FALSE(arrival.settled());
  EXPECT_TRUE(arrival.look(at_s(11.0), 0.4, options));
  EXPECT_TRUE(arrival.settled());
  EXPECT_TRUE(arrival.look(at_s(12.0), 0.0, options));  // what is known is not doubted here
}

TEST(Arrival, BeginsAnewAfterAPlaceThatWasAnother) {
  const ArrivalOptions options{1.0, 0.3};
  Arrival arrival(false);
  EXPECT_TRUE(arrival.look(at_s(10.0), 0.35, options));
  EXPECT_FALSE(arrival.look(at_s(10.9), 0.2, options));
  EXPECT_FALSE(arrival.settled());
  EXPECT_TRUE(arrival.look(at_s(11.0), 0.5, options));
  EXPECT_FALSE(arrival.settled());
  EXPECT_TRUE(arrival.look(at_s(12.0), 0.5, options));
  EXPECT_TRUE(arrival.settled());
}

/// The same things, most of which stand a little elsewhere: the next room of a row.
PointWorld next_room(PointWorld world) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift_m(-0.08, 0.08);
  for (std::size_t i = 0; i < world.p_world.size(); ++i) {
    if (i % 6 == 0) continue;
    world.p_world[i] += Eigen::Vector3d(shift_m(random), shift_m(random), shift_m(random));
  }
  return world;
}

/// What comes of two seconds in the next room with the map of this one.
struct Visit {
  int misplaced = 0;  ///< frames that are tracked in it
  int keyframes = 0;  ///< that enter it
};

Visit visit_next_room(const TrackerOptions& options) {
  Walk walk(options);
  for (int i = 0; i < 60; ++i) walk.step();
  walk.restart(options);
  const PointWorld room = next_room(walk.world());
  Visit visit;
  for (int i = 0; i < 60; ++i) {
    const TrackResult result = walk.step_in(room, Walk::path(60 + i), 1.0);
    const auto in_first_map = [&](KeyFrameId id) {
      return id.valid() && walk.atlas().at(id).map.slot == 0;
    };
    const bool tracking = result.state == TrackingState::tracking;
    visit.misplaced += tracking && in_first_map(result.reference) ? 1 : 0;
    visit.keyframes += result.candidate && in_first_map(result.candidate->reference) ? 1 : 0;
  }
  return visit;
}

TEST(Arrival, ARoomThatLooksAlikeIsNotTakenForTheOneThatIsKnown) {
  TrackerOptions believing;
  believing.min_agreement = believing.arrival.min_agreement = 0;
  const Visit believed = visit_next_room(believing);
  EXPECT_GT(believed.misplaced, 50);
  EXPECT_GT(believed.keyframes, 0);
  const Visit doubted = visit_next_room(TrackerOptions{});
  EXPECT_LT(doubted.misplaced, 15);
  EXPECT_EQ(doubted.keyframes, 0);
}

}  // namespace
}  // namespace ydd
