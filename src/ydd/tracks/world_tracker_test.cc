// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracks/world_tracker.h"

#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace ydd {
namespace {

using Eigen::Vector3d;
using testing::IsEmpty;
using testing::SizeIs;

Timestamp at_s(double s) { return {static_cast<std::int64_t>(s * 1e9)}; }

Sighting person(const Vector3d& p_camera, std::int64_t image_track = -1) {
  Sighting s;
  s.class_name = "person";
  s.image_track = image_track;
  s.p_camera = p_camera;
  s.covariance_m2 = 0.05 * 0.05 * Eigen::Matrix3d::Identity();
  s.extent_m = {0.5, 1.7, 0.22};
  s.moves = true;
  return s;
}

/// A camera that moves and turns round.
SE3 camera_at(double t) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * t, Vector3d::UnitY())),
          Vector3d(0.2 * t, 0, -0.1 * t)};
}

TEST(WorldTracker, FindsPlaceAndVelocityInTheWorldWhateverTheCameraDoes) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.05);
  WorldTracker tracker({});
  const Vector3d start(0, 0, 3), v(0.8, 0, -0.4);
  double t = 0;
  for (int i = 0; i < 60; ++i, t = i / 30.0) {
    const Vector3d p = start + v * t + Vector3d{noise(random), noise(random), noise(random)};
    tracker.see(at_s(t), camera_at(t), std::vector{person(camera_at(t).inverse() * p)});
  }
  ASSERT_THAT(tracker.tracks(), SizeIs(1));
  const WorldTrack track = tracker.tracks()[0];
  EXPECT_LT((track.position_m - (start + v * 59 / 30.0)).norm(), 0.1);
  EXPECT_LT((track.velocity_m_s - v).norm(), 0.3);
  EXPECT_NEAR(track.age_s, 59 / 30.0, 1e-6);
  EXPECT_EQ(track.unseen_s, 0);
  EXPECT_TRUE(track.moves);
}

TEST(WorldTracker, ItsCovarianceIsThatOfItsErrors) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  WorldTrackOptions options;
  double nees = 0;
  int count = 0;
  constexpr double kStep_s = 1.0 / 30;
  for (int run = 0; run < 40; ++run) {
    WorldTracker tracker(options);
    Vector3d p(0, 0, 3), v(0, 0, 0);
    for (int i = 0; i < 60; ++i) {
      for (int k = 0; k < 3; ++k) {  // the white acceleration that the filter believes in
        v[k] += options.speed_change_m_s * std::sqrt(kStep_s) * normal(random);
      }
      p += kStep_s * v;
      Vector3d measured = p;
      for (int k = 0; k < 3; ++k) measured[k] += 0.05 * normal(random);
      tracker.see(at_s(i * kStep_s), SE3(), std::vector{person(measured)});
      if (i < 30) continue;
      const WorldTrack track = tracker.tracks().at(0);
      const Vector3d off = track.position_m - p;
      nees += off.dot(track.position_covariance_m2.llt().solve(off));
      ++count;
    }
  }
  EXPECT_NEAR(nees / count, 3.0, 0.5);  // degrees of freedom
}

TEST(WorldTracker, IsToldOfAfterSomeSightingsOnly) {
  WorldTrackOptions options;
  options.confirm = 3;
  WorldTracker tracker(options);
  for (int i = 0; i < 2; ++i) tracker.see(at_s(i / 30.0), SE3(), std::vector{person({0, 0, 2})});
  EXPECT_THAT(tracker.tracks(), IsEmpty());
  tracker.see(at_s(2 / 30.0), SE3(), std::vector{person({0, 0, 2})});
  EXPECT_THAT(tracker.tracks(), SizeIs(1));
}

TEST(WorldTracker, OneThatWasNeverSureIsNotToldOf) {
  WorldTracker tracker({});
  Sighting doubtful = person({0, 0, 2});
  doubtful.sure = false;
  int i = 0;
  for (; i < 30; ++i) tracker.see(at_s(i / 30.0), SE3(), std::vector{doubtful});
  EXPECT_THAT(tracker.tracks(), IsEmpty());
  tracker.see(at_s(i++ / 30.0), SE3(), std::vector{person({0, 0, 2})});
  ASSERT_THAT(tracker.tracks(), SizeIs(1)) << "sure once is enough";
  tracker.see(at_s(i / 30.0), SE3(), std::vector{doubtful});
  ASSERT_THAT(tracker.tracks(), SizeIs(1));
  EXPECT_NEAR(tracker.tracks()[0].age_s, 1, 0.05) << "known since the first glimpse";
}

/// Walked for two seconds with one metre a second to the right, seen until then.
WorldTracker walked() {
  WorldTracker tracker({});
  for (int i = 0; i <= 60; ++i) {
    tracker.see(at_s(i / 30.0), SE3(), std::vector{person({i / 30.0, 0, 3})});
  }
  return tracker;
}

TEST(WorldTracker, CoastsAsItWentWithGrowingCovarianceAndThenEnds) {
  WorldTracker tracker = walked();
  const WorldTrack before = tracker.tracks().at(0);
  for (int i = 61; i <= 75; ++i) tracker.coast(at_s(i / 30.0));
  ASSERT_THAT(tracker.tracks(), SizeIs(1));
  const WorldTrack coasted = tracker.tracks()[0];
  EXPECT_NEAR(coasted.position_m.x(), 2.5, 0.1);
  EXPECT_NEAR(coasted.unseen_s, 0.5, 1e-6);
  EXPECT_GT(coasted.position_covariance_m2.trace(), 5 * before.position_covariance_m2.trace());
  for (int i = 76; i <= 89; ++i) tracker.see(at_s(i / 30.0), SE3(), {});
  EXPECT_THAT(tracker.tracks(), SizeIs(1));
  for (int i = 90; i <= 91; ++i) tracker.see(at_s(i / 30.0), SE3(), {});
  EXPECT_THAT(tracker.tracks(), IsEmpty());
}

TEST(WorldTracker, WhoIsSeenAgainIsTheSame) {
  WorldTracker tracker = walked();
  const std::int64_t id = tracker.tracks().at(0).id;
  for (int i = 61; i <= 80; ++i) tracker.coast(at_s(i / 30.0));
  tracker.see(at_s(81 / 30.0), SE3(), std::vector{person({2.75, 0, 3})});
  ASSERT_THAT(tracker.tracks(), SizeIs(1));
  EXPECT_EQ(tracker.tracks()[0].id, id);
  EXPECT_EQ(tracker.tracks()[0].unseen_s, 0);
}

TEST(WorldTracker, PersonsWhoCrossKeepTheirNumbers) {
  WorldTracker tracker({});
  for (int i = 0; i <= 90; ++i) {
    const double x = -1.5 + i / 30.0;  // they meet at 1.5 s, 0.6 m apart in depth
    std::vector<Sighting> seen = {person({x, 0, 2.0}, 1)};
    // The one behind is hidden for a while and gets another number in the picture.
    if (std::abs(x) > 0.25) seen.push_back(person({-x, 0, 2.6}, i < 45 ? 2 : 3));
    tracker.see(at_s(i / 30.0), SE3(), seen);
  }
  ASSERT_THAT(tracker.tracks(), SizeIs(2));
  EXPECT_EQ(tracker.tracks()[0].id, 0);
  EXPECT_NEAR(tracker.tracks()[0].position_m.x(), 1.5, 0.1);
  EXPECT_EQ(tracker.tracks()[1].id, 1);
  EXPECT_NEAR(tracker.tracks()[1].position_m.x(), -1.5, 0.1);
}

TEST(WorldTracker, GoesWithTheMapWhereThatIsCorrected) {
  WorldTracker tracker = walked();
  const SE3 turn(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY())),
                 Vector3d(10, 0, 0));
  const WorldTrack before = tracker.tracks().at(0);
  tracker.move(turn);
  const WorldTrack after = tracker.tracks().at(0);
  EXPECT_LT((after.position_m - turn * before.position_m).norm(), 1e-9);
  EXPECT_LT((after.velocity_m_s - turn.rotation() * before.velocity_m_s).norm(), 1e-9);
  EXPECT_NEAR(after.position_covariance_m2(2, 2), before.position_covariance_m2(0, 0), 1e-9);
}

TEST(WorldTracker, AThingThatIsRecognisedKeepsItsNumber) {
  WorldTracker tracker({});
  for (int i = 0; i < 10; ++i) {
    Sighting s = person({0, 0, 2});
    if (i < 5) s.class_name = kThing;
    tracker.see(at_s(i / 30.0), SE3(), std::vector{s});
  }
  ASSERT_THAT(tracker.tracks(), SizeIs(1));
  EXPECT_EQ(tracker.tracks()[0].class_name, "person");
  Sighting chair = person({0, 0, 2});
  chair.class_name = "chair";
  for (int i = 10; i < 13; ++i) tracker.see(at_s(i / 30.0), SE3(), std::vector{chair});
  EXPECT_THAT(tracker.tracks(), SizeIs(2));  // a chair is no person
}

TEST(WorldTracker, StampsThatFallBackPassNoTime) {
  WorldTracker tracker = walked();
  tracker.see(at_s(1.0), SE3(), std::vector{person({2.0, 0, 3})});
  ASSERT_THAT(tracker.tracks(), SizeIs(1));
  EXPECT_NEAR(tracker.tracks()[0].position_m.x(), 2.0, 0.05);
}

}  // namespace
}  // namespace ydd
