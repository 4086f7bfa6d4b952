// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/track_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ydd {
namespace {

using nlohmann::json;

WorldTrack someone() {
  WorldTrack track;
  track.id = 3;
  track.class_name = "person";
  track.position_m = {1, 2, 3};
  track.velocity_m_s = {0.5, 0, -0.25};
  track.extent_m = {0.5, 1.7, 0.22};
  track.position_covariance_m2 << 0.01, 0.002, 0, 0.002, 0.02, 0, 0, 0, 0.03;
  track.age_s = 1.5;
  track.moves = true;
  track.log_odds = 2.0F;
  return track;
}

TEST(TrackRecorder, TellsEverythingOfATrackInOneLine) {
  const std::string line = to_json_line({12, {1'400'000'000}, 0, {someone()}});
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const json frame = json::parse(line);
  EXPECT_EQ(frame["frame"], 12);
  EXPECT_NEAR(frame["stamp_s"].get<double>(), 1.4, 1e-9);
  EXPECT_EQ(frame["map"], 0);
  const json& track = frame["tracks"].at(0);
  EXPECT_EQ(track["id"], 3);
  EXPECT_EQ(track["class"], "person");
  EXPECT_EQ(track["position_m"], json({1.0, 2.0, 3.0}));
  EXPECT_EQ(track["covariance_m2"], json({0.01, 0.002, 0.0, 0.02, 0.0, 0.03}));
  EXPECT_EQ(track["velocity_m_s"], json({0.5, 0.0, -0.25}));
  EXPECT_EQ(track["moving"], true);
  EXPECT_NEAR(track["log_odds"].get<double>(), 2.0, 1e-6);
}

TEST(TrackRecorder, WhatIsNotKnownIsNull) {
  WorldTrack track = someone();
  track.log_odds.reset();
  const json frame = json::parse(to_json_line({0, {}, -1, {track}}));
  EXPECT_TRUE(frame["map"].is_null());
  EXPECT_TRUE(frame["tracks"].at(0)["log_odds"].is_null());
}

/// A map of one keyframe, which stands at `x_m`.
std::pair<Atlas, KeyFrameId> map_at(double x_m) {
  Atlas atlas(Camera{}, PyramidScales::make(8, 1.2));
  KeyFrame keyframe;
  keyframe.shared_features = std::make_shared<const Features>();
  keyframe.T_world_camera = SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(x_m, 0, 0));
  const KeyFrameId id = atlas.add_keyframe(std::move(keyframe));
  return {std::move(atlas), id};
}

TEST(TrackRecorder, TracksAreToldInTheFinalStateOfTheMap) {
  const auto [atlas, id] = map_at(5);  // it stood at 0 when the frame was tracked
  TrackRecorder recorder;
  FrameReport report;
  report.track.reference = id;
  report.tracks = {someone()};
  recorder.add(report);
  FrameReport lost;  // placed as the frame before
  lost.index = 1;
  lost.tracks = {someone()};
  recorder.add(lost);
  const auto frames = recorder.frames(atlas);
  ASSERT_EQ(frames.size(), 2U);
  for (const TracksOfFrame& frame : frames) {
    EXPECT_NEAR(frame.tracks.at(0).position_m.x(), 6, 1e-9);
    EXPECT_EQ(frame.map, 0);
  }
}

TEST(FollowedObjects, KnowHowTheirMapWasCorrected) {
  const auto [before, id] = map_at(0);
  const PlacedFrame place{id, SE3(), SE3()};
  EXPECT_NEAR(correction_since(place, map_at(5).first).value().translation().x(), 5, 1e-12);
  EXPECT_FALSE(correction_since({KeyFrameId{7, 1}, SE3(), SE3()}, before).has_value());
}

}  // namespace
}  // namespace ydd
