// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/cameras/camera_modes.h"
#include "ydd/cameras/device_clock.h"
#include "ydd/cameras/live_pairing.h"

namespace ydd {
namespace {

using testing::HasSubstr;

const std::vector<CameraMode> kColour = {
    {320, 240, 30}, {640, 480, 30}, {1280, 1024, 30}, {640, 480, 25}};
const std::vector<CameraMode> kDepth = {
    {320, 240, 60}, {320, 240, 30}, {640, 480, 30}, {640, 480, 30}};

TEST(CameraModes, AreReadAsTheyAreWritten) {
  EXPECT_EQ(parse_camera_mode("640x480@30"), (CameraMode{640, 480, 30}));
  EXPECT_EQ(to_string(CameraMode{320, 240, 60}), "320x240@60");
  for (const char* const bad : {"", "640x480", "640x480@", "640@30", "axb@c", "640x480@30 ",
                                "-640x480@30", "640x0@30", "999999x1@1", "640x480@30x"}) {
    EXPECT_FALSE(parse_camera_mode(bad)) << bad;
  }
}

TEST(CameraModes, TheUsualOneIsTakenWhereBothStreamsHaveIt) {
  EXPECT_EQ(choose_camera_mode(kColour, kDepth, "").value(), (CameraMode{640, 480, 30}));
  EXPECT_EQ(choose_camera_mode(kColour, kDepth, "320x240@30").value(), (CameraMode{320, 240, 30}));
}

TEST(CameraModes, OtherwiseWhatComesNearest) {
  const auto nearest = [](const std::vector<CameraMode>& modes) {
    return to_string(choose_camera_mode(modes, modes, "").value());
  };
  EXPECT_EQ(nearest({{1280, 960, 30}, {320, 240, 60}, {320, 240, 15}}), "320x240@60");
  EXPECT_EQ(nearest({{1280, 960, 7}, {1920, 1080, 30}}), "1280x960@7");
  EXPECT_EQ(nearest({{640, 480, 60}, {640, 480, 15}}), "640x480@60");
  EXPECT_EQ(nearest({{640, 480, 5}, {640, 480, 15}}), "640x480@15");
}

TEST(CameraModes, WhatThereIsNotIsOneLineWithWhatThereIs) {
  const auto error = [](const std::string& wanted) {
    return choose_camera_mode(kColour, kDepth, wanted).error().message;
  };
  EXPECT_EQ(error("1280x1024@30"),
            "has no depth in 1280x1024@30 (--mode); there are: 320x240@30, 320x240@60, 640x480@30");
  EXPECT_THAT(error("320x240@60"), HasSubstr("has no colour in 320x240@60 (--mode); there are:"));
  EXPECT_THAT(error("large"), HasSubstr("expected a mode such as 640x480@30, found 'large'"));
  EXPECT_EQ(choose_camera_mode({{640, 480, 30}}, {}, "").error().message,
            "has no mode that colour (640x480@30) and depth (none) share");
}

Timestamp ms(std::int64_t value) { return {value * 1'000'000}; }

TEST(DeviceClock, KeepsTheIntervalsOfTheDevice) {
  DeviceClock clock;
  EXPECT_EQ(clock.to_host(ms(5), ms(1000)), ms(1000));
  EXPECT_EQ(clock.to_host(ms(38), ms(1090)), ms(1033));  // it came late
  EXPECT_EQ(clock.to_host(ms(71), ms(1091)), ms(1066));
}

TEST(DeviceClock, IsSetAnewWhenTheDevicesStartsAnew) {
  DeviceClock clock;
  clock.to_host(ms(5000), ms(10'000));
  clock.restart();
  EXPECT_EQ(clock.to_host(ms(3), ms(13'000)), ms(13'000));
  EXPECT_EQ(clock.to_host(ms(1), ms(14'000)), ms(14'000)) << "it went backwards";
  EXPECT_EQ(clock.to_host(ms(900'000), ms(14'033)), ms(14'033)) << "it jumped ahead";
  EXPECT_EQ(clock.to_host(ms(903'000), ms(17'033)), ms(17'033)) << "a pause is none";
}

TEST(DeviceClock, NeverGoesBackwards) {
  DeviceClock clock;
  clock.to_host(ms(100), ms(1000));
  clock.to_host(ms(900), ms(1010));  // 790 ms early: no jump
  EXPECT_EQ(clock.to_host(ms(1), ms(1020)).ns, ms(1800).ns + 1000);
}

class Pairing : public testing::Test {
 protected:
  void colour(std::int64_t at_ms) { pairing_.add(LiveColour{ms(at_ms), {}, {}}); }
  void depth(std::int64_t at_ms) { pairing_.add(LiveDepth{ms(at_ms), {}, {}}); }
  /// Milliseconds of colour and depth; nothing: none yet.
  std::optional<std::pair<std::int64_t, std::int64_t>> taken() {
    const auto pair = pairing_.take();
    if (!pair) return std::nullopt;
    return std::pair(pair->colour.device.ns / 1'000'000, pair->depth.device.ns / 1'000'000);
  }
  LivePairing pairing_{0.02};
};
using Pair = std::pair<std::int64_t, std::int64_t>;

TEST_F(Pairing, TakesTheNearestInTime) {
  colour(100);
  EXPECT_FALSE(taken());
  depth(85);
  EXPECT_FALSE(taken()) << "a nearer one may still come";
  depth(107);
  EXPECT_EQ(taken(), Pair(100, 107));
  EXPECT_FALSE(taken());
  depth(130);
  colour(133);  // so near that no other can be nearer
  EXPECT_EQ(taken(), Pair(133, 130));
  EXPECT_EQ(pairing_.unpaired(), 0);
}

TEST_F(Pairing, CountsColourWithoutDepth) {
  colour(0);
  colour(33);
  depth(33);
  EXPECT_EQ(taken(), Pair(33, 33));
  EXPECT_EQ(pairing_.unpaired(), 1);
  for (int i = 2; i < 12; ++i) {  // depth stands still
    colour(33 * i);
    EXPECT_FALSE(taken());
  }
  EXPECT_EQ(pairing_.unpaired(), 7);
  depth(33 * 11);
  EXPECT_EQ(taken(), Pair(33 * 11, 33 * 11));
  EXPECT_EQ(pairing_.unpaired(), 10);
}

TEST_F(Pairing, DepthAloneIsNotKeptForEver) {
  for (int i = 0; i < 1000; ++i) depth(33 * i);
  colour(33 * 999);
  EXPECT_EQ(taken(), Pair(33 * 999, 33 * 999));
  colour(0);
  pairing_.clear();
  EXPECT_FALSE(taken());
  EXPECT_EQ(pairing_.unpaired(), 1);
}

}  // namespace
}  // namespace ydd
