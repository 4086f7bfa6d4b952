// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/person_tracks.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

const BridgingOptions kBridging;

MovingRegion body_at(float x) {
  return {0, Rule::body_depth, {x, 100, x + 100, 400}, DepthRange{1.0F, 2.0F}};
}

/// The persons after a frame, and the regions that it gave.
struct Followed {
  PersonTracks persons;
  std::vector<MovingRegion> bodies;   ///< as detected, with their tracks
  std::vector<MovingRegion> regions;  ///< of those that were missed
  const std::vector<ObjectTrack>& tracks() const { return persons.tracks(); }
};

Followed step(Followed state, std::vector<MovingRegion> bodies,
              const BridgingOptions& options = kBridging) {
  state.bodies = std::move(bodies);
  state.regions = state.persons.follow(state.bodies, 640, 480, options);
  return state;
}

/// A person seen in `frames` frames, 10 px further right in each.
Followed walked(int frames) {
  Followed state;
  for (int i = 0; i < frames; ++i) state = step(state, {body_at(100 + 10 * static_cast<float>(i))});
  return state;
}

TEST(PersonTracks, APersonInSightNeedsNoBridge) {
  const Followed state = walked(4);
  EXPECT_TRUE(state.regions.empty());
  ASSERT_EQ(state.tracks().size(), 1U);
  EXPECT_EQ(state.tracks()[0].seen, 4);
  EXPECT_FLOAT_EQ(state.tracks()[0].dx_px, 10);
  EXPECT_FLOAT_EQ(state.tracks()[0].dy_px, 0);
}

TEST(PersonTracks, OfTwoBodiesTheOneThatFitsBetterGoesOn) {
  // The nearer one stands second, so that the order of the bodies does not decide.
  const Followed state = step(walked(3), {body_at(160), body_at(131)});
  ASSERT_EQ(state.tracks().size(), 2U);
  EXPECT_EQ(state.tracks()[0].seen, 1);
  EXPECT_EQ(state.tracks()[1].seen, 4);
}

TEST(PersonTracks, AMissedPersonIsCarriedOnByItsMotion) {
  const Followed once = step(walked(3), {});
  ASSERT_EQ(once.regions.size(), 1U);
  EXPECT_EQ(once.regions[0].rule, Rule::bridged);
  EXPECT_EQ(once.regions[0].object, -1);
  EXPECT_EQ(once.regions[0].box, (Box{130, 100, 230, 400}));
  EXPECT_EQ(once.regions[0].range, (DepthRange{1.0F, 2.0F}));
  EXPECT_EQ(step(once, {}).regions[0].box, (Box{140, 100, 240, 400}));
}

TEST(PersonTracks, OnlySoLong) {
  Followed state = walked(3);
  BridgingOptions options;
  options.frames = 3;
  for (int i = 0; i < 3; ++i) {
    state = step(state, {}, options);
    EXPECT_EQ(state.regions.size(), 1U) << i;
  }
  state = step(state, {}, options);
  EXPECT_TRUE(state.regions.empty());
  EXPECT_TRUE(state.tracks().empty());
}

TEST(PersonTracks, AFlickerIsNotCarriedOn) { EXPECT_TRUE(step(walked(2), {}).regions.empty()); }

TEST(PersonTracks, APersonSeenAgainGoesOnAsBefore) {
  const Followed again = step(step(walked(3), {}), {body_at(141)});
  EXPECT_TRUE(again.regions.empty());
  ASSERT_EQ(again.tracks().size(), 1U);
  EXPECT_EQ(again.tracks()[0].missed, 0);
  EXPECT_EQ(again.tracks()[0].seen, 4);
  EXPECT_FLOAT_EQ(again.tracks()[0].dx_px, 10);
}

TEST(PersonTracks, OneThatLeavesTheImageEnds) {
  Followed state;
  for (int i = 0; i < 3; ++i) {
    state = step(state, {body_at(400 + 95 * static_cast<float>(i))}, {10, 3, 0.01});
  }
  ASSERT_EQ(state.tracks().size(), 1U);
  EXPECT_TRUE(step(state, {}).regions.empty());
}

TEST(PersonTracks, TwoPersonsKeepTheirTracks) {
  Followed state;
  for (int i = 0; i < 3; ++i) state = step(state, {body_at(100), body_at(160)});
  state = step(state, {body_at(158)});
  ASSERT_EQ(state.regions.size(), 1U);
  EXPECT_EQ(state.regions[0].box.x0, 100);
  EXPECT_EQ(state.regions[0].track, 0);
  EXPECT_EQ(state.bodies[0].track, 1);
}

TEST(PersonTracks, AFullRejectionIsCarriedOnAsSuch) {
  MovingRegion whole = body_at(100);
  whole.range.reset();
  Followed state;
  for (int i = 0; i < 3; ++i) state = step(state, {whole});
  ASSERT_EQ(step(state, {}).regions.size(), 1U);
  EXPECT_FALSE(step(state, {}).regions[0].range);
}

}  // namespace
}  // namespace ydd
