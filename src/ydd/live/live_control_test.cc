// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(LiveCommand, TextAndBack) {
  for (const char* const text :
       {"pause", "resume", "step", "reset", "save map", "localize on", "localize off", "quit",
        "variant off", "variant box", "variant person", "variant full", "variant evidence"}) {
    const Result<LiveCommand> command = parse_live_command(text);
    ASSERT_TRUE(command) << text;
    EXPECT_EQ(to_string(*command), text);
  }
}

TEST(LiveCommand, WhatIsNoneIsNamedWithWhatThereIs) {
  for (const char* const text : {"", "stop", "variant", "variant none", "Pause", "variant  full"}) {
    const Result<LiveCommand> command = parse_live_command(text);
    ASSERT_FALSE(command) << text;
    EXPECT_THAT(command.error().message, testing::HasSubstr("pause, resume, step"));
  }
}

TEST(LiveControl, CommandsComeOutInOrderUntilItIsClosed) {
  LiveControl control(LiveScene{});
  EXPECT_TRUE(control.send(live::Pause{}));
  EXPECT_TRUE(control.send(live::SetVariant{Variant::box}));
  EXPECT_EQ(to_string(control.next_command(0).value()), "pause");
  EXPECT_EQ(to_string(control.next_command(1000).value()), "variant box");
  EXPECT_FALSE(control.next_command(0));
  EXPECT_FALSE(control.next_command(1));
  EXPECT_EQ(control.end(), LiveEnd::running);
  control.close(LiveEnd::failed);
  EXPECT_EQ(control.end(), LiveEnd::failed);
  EXPECT_FALSE(control.send(live::Quit{}));
}

TEST(LiveControl, AWatcherThatFloodsIsRefusedAndNobodyWaits) {
  LiveControl control(LiveScene{});
  int taken = 0;
  while (taken < 1000 && control.send(live::Step{})) ++taken;
  EXPECT_GT(taken, 10);
  EXPECT_LT(taken, 1000);
}

TEST(LiveControl, ShowsTheNewestFrame) {
  LiveControl control(LiveScene{});
  EXPECT_EQ(control.newest(), nullptr);
  for (int serial = 1; serial <= 3; ++serial) {
    LiveFrame frame;
    frame.serial = serial;
    control.publish(std::make_shared<const LiveFrame>(frame));
  }
  EXPECT_EQ(control.newest()->serial, 3);
}

}  // namespace
}  // namespace ydd
