// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/video_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

class VideoFileTest : public testing::Test {
 protected:
  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
};

ColourImage grey(std::uint8_t value) {
  return {64, 48, std::vector<Bgr>(64U * 48U, Bgr{value, value, value})};
}

TEST_F(VideoFileTest, AppearsWhenItIsFinished) {
  auto video = VideoFile::open(folder_ / "a.mp4", 64, 48, 30);
  ASSERT_TRUE(video) << video.error().message;
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(video->add(grey(static_cast<std::uint8_t>(20 * i))));
  EXPECT_FALSE(fs::exists(folder_ / "a.mp4"));
  ASSERT_TRUE(video->finish());
  EXPECT_GT(fs::file_size(folder_ / "a.mp4"), 300U);
}

TEST_F(VideoFileTest, LeavesNothingUnfinished) {
  { ASSERT_TRUE(VideoFile::open(folder_ / "a.mp4", 64, 48, 30)->add(grey(7))); }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(VideoFileTest, TellsWhatIsWrong) {
  const auto kind = VideoFile::open(folder_ / "a.avi", 64, 48, 30);
  ASSERT_FALSE(kind);
  EXPECT_THAT(kind.error().message, testing::HasSubstr("*.mp4"));
  const auto nowhere = VideoFile::open(folder_ / "no/a.mp4", 64, 48, 30);
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, testing::HasSubstr("cannot write"));
  auto video = VideoFile::open(folder_ / "a.mp4", 32, 48, 30);
  ASSERT_TRUE(video);
  EXPECT_THROW((void)video->add(grey(1)), std::logic_error);
}

}  // namespace
}  // namespace ydd
