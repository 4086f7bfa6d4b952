// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/source.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/image/decode.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

constexpr int kWidth = 32;
constexpr int kHeight = 24;

Camera small_camera() {
  Camera camera;
  camera.name = "small";
  camera.width_px = kWidth;
  camera.height_px = kHeight;
  return camera;
}

/// A folder with three good frames at 1.0, 1.1 and 1.2 s that each test spoils in its own way.
class TumSequenceTest : public testing::Test {
 protected:
  TumSequenceTest()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("sequence_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "rgb");
    fs::create_directories(folder_ / "depth");
    write("rgb.txt", "# time file\n1.0 rgb/0.png\n1.1 rgb/1.png\n1.2 rgb/2.png\n");
    write("depth.txt", "# time file\n1.01 depth/0.png\n1.11 depth/1.png\n1.19 depth/2.png\n");
    for (int i = 0; i < 3; ++i) {
      const std::string name = std::to_string(i) + ".png";
      put_colour("rgb/" + name, kWidth, kHeight);
      put_depth("depth/" + name, kWidth, kHeight);
    }
  }
  ~TumSequenceTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void put_colour(const std::string& name, int width, int height) const {
    std::vector<Bgr> pixels(std::size_t(width) * height, Bgr{10, 20, 30});
    ASSERT_TRUE(write_png(folder_ / name, ColourImage(width, height, std::move(pixels))));
  }
  void put_depth(const std::string& name, int width, int height) const {
    std::vector<std::uint16_t> counts(std::size_t(width) * height, 7500);
    ASSERT_TRUE(write_png(folder_ / name, RawDepthImage(width, height, std::move(counts))));
  }
  void truncate(const std::string& name, std::uintmax_t removed) const {
    fs::resize_file(folder_ / name, fs::file_size(folder_ / name) - removed);
  }

  std::string open_error(const SequenceOptions& options = {}) const {
    const auto sequence = open_sequence(folder_, options);
    return sequence ? "no error" : sequence.error().message;
  }
  std::string read_error(std::size_t i) const {
    const auto sequence = open_sequence(folder_);
    if (!sequence) return "cannot open: " + sequence.error().message;
    const auto frame = sequence->read(i, small_camera());
    return frame ? "no error" : frame.error().message;
  }

  fs::path folder_;
};

TEST_F(TumSequenceTest, ReadsFrames) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  ASSERT_EQ(sequence->size(), 3U);
  EXPECT_EQ(sequence->name(), folder_.filename().string());
  EXPECT_FALSE(sequence->groundtruth());
  EXPECT_EQ(sequence->entry(1).stamp.ns, 1'100'000'000);
  EXPECT_EQ(sequence->entry(1).depth_stamp.ns, 1'110'000'000);
  const auto frame = sequence->read(1, small_camera());
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->index, 1);
  EXPECT_EQ(frame->stamp.ns, 1'100'000'000);
  EXPECT_EQ(frame->colour(5, 6), (Bgr{10, 20, 30}));
  EXPECT_EQ(frame->grey(5, 6), 22);  // 0.114 * 10 + 0.587 * 20 + 0.299 * 30 = 21.85
  EXPECT_FLOAT_EQ(frame->depth_m(5, 6), 1.5F);
}

TEST_F(TumSequenceTest, FindsGroundTruth) {
  write("groundtruth.txt", "1.0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(open_sequence(folder_)->groundtruth()->place, folder_ / "groundtruth.txt");
}

TEST_F(TumSequenceTest, ColourWithoutDepthIsLeftOut) {
  write("depth.txt", "1.01 depth/0.png\n1.19 depth/2.png\n");
  const auto sequence = open_sequence(folder_);
  ASSERT_EQ(sequence->size(), 2U);
  EXPECT_THAT(sequence->entry(1).colour_name, EndsWith("rgb/2.png"));
}

TEST_F(TumSequenceTest, AssociationFileIsUsedOnlyWhenGiven) {
  write("associations.txt", "1.0 rgb/0.png 1.19 depth/2.png\n1.1 rgb/1.png 1.19 depth/2.png\n");
  EXPECT_EQ(open_sequence(folder_)->size(), 3U);
  const SequenceOptions options{.associations = (folder_ / "associations.txt").string()};
  const auto sequence = open_sequence(folder_, options);
  ASSERT_TRUE(sequence) << sequence.error().message;
  ASSERT_EQ(sequence->size(), 2U);
  EXPECT_THAT(sequence->entry(0).depth_name, EndsWith("depth/2.png"));
}

TEST_F(TumSequenceTest, BadAssociationFile) {
  const SequenceOptions options{.associations = (folder_ / "a.txt").string()};
  EXPECT_THAT(open_error(options), HasSubstr("a.txt: cannot be opened"));
  write("a.txt", "1.0 rgb/0.png 1.0\n");
  EXPECT_THAT(open_error(options), HasSubstr("a.txt:1: expected 'timestamp file timestamp file'"));
  write("a.txt", "1.0 rgb/0.png x depth/0.png\n");
  EXPECT_THAT(open_error(options), HasSubstr("a.txt:1: 'x' is not a time"));
  write("a.txt", "1.0 r.png 1.0 d.png\n1.0 r.png 1.0 d.png\n");
  EXPECT_THAT(open_error(options), HasSubstr("a.txt:2: duplicate stamp 1.0"));
  write("a.txt", "# nothing\n");
  EXPECT_THAT(open_error(options), HasSubstr("a.txt: lists no image"));
}

TEST_F(TumSequenceTest, MissingOrEmptyFolder) {
  fs::remove_all(folder_);
  EXPECT_THAT(open_error(), EndsWith(": no such file or folder"));
  fs::create_directories(folder_);
  EXPECT_THAT(open_error(), AllOf(HasSubstr(": has no rgb.txt, "), Not(HasSubstr("\n"))));
  write("rgb.txt", "1.0 rgb/0.png\n");
  EXPECT_THAT(open_error(), HasSubstr(": has no depth.txt; "));
  write("depth.txt", "# only a comment\n\n");
  EXPECT_THAT(open_error(), EndsWith("depth.txt: lists no image"));
  EXPECT_THAT(open_sequence(folder_ / "rgb.txt", {.source = "tum"}).error().message,
              HasSubstr("is not a folder"));
}

TEST_F(TumSequenceTest, BrokenListLines) {
  write("rgb.txt", "# time file\n1.0 rgb/0.png\n1.1\n");
  EXPECT_THAT(open_error(), EndsWith("rgb.txt:3: expected 'timestamp file', found '1.1'"));
  write("rgb.txt", "1.0 rgb/0.png and more\n");
  EXPECT_THAT(open_error(),
              HasSubstr("rgb.txt:1: expected 'timestamp file', found '1.0 rgb/0.png"));
  write("rgb.txt", "now rgb/0.png\n");
  EXPECT_THAT(open_error(), EndsWith("rgb.txt:1: 'now' is not a time in seconds"));
}

TEST_F(TumSequenceTest, StampsMustIncrease) {
  write("rgb.txt", "1.0 rgb/0.png\n1.2 rgb/1.png\n1.1 rgb/2.png\n");
  EXPECT_THAT(open_error(),
              HasSubstr("rgb.txt:3: stamp 1.1 is earlier than the one before (1.200000000)"));
  write("rgb.txt", "1.0 rgb/0.png\n1.00 rgb/1.png\n");
  EXPECT_THAT(open_error(), EndsWith("rgb.txt:2: duplicate stamp 1.00"));
}

TEST_F(TumSequenceTest, NoPairWithinTolerance) {
  write("depth.txt", "1.05 depth/0.png\n2.0 depth/1.png\n");
  EXPECT_THAT(open_error(),
              HasSubstr("no colour image within 0.02 s of a depth image (the closest two are "
                        "0.050000 s apart)"));
  EXPECT_EQ(open_sequence(folder_, {.max_difference_s = 0.06})->size(), 1U);
}

TEST_F(TumSequenceTest, TruncatedImage) {
  truncate("rgb/1.png", 3);
  EXPECT_EQ(read_error(0), "no error");
  EXPECT_THAT(read_error(1), HasSubstr("rgb/1.png: is truncated"));
  truncate("depth/2.png", 40);
  EXPECT_THAT(read_error(2), HasSubstr("depth/2.png: is truncated"));
  write("depth/0.png", "");
  EXPECT_THAT(read_error(0), EndsWith("depth/0.png: is an empty file"));
}

TEST_F(TumSequenceTest, MissingImage) {
  fs::remove(folder_ / "rgb/1.png");
  EXPECT_THAT(read_error(1), EndsWith("rgb/1.png: cannot be opened for reading"));
  fs::remove(folder_ / "depth/2.png");
  EXPECT_THAT(read_error(2), EndsWith("depth/2.png: cannot be opened for reading"));
}

TEST_F(TumSequenceTest, WrongSize) {
  put_depth("depth/0.png", 16, 24);
  EXPECT_THAT(read_error(0),
              HasSubstr("depth/0.png: frame 0 is 16x24 but its colour image is 32x24"));
  put_colour("rgb/1.png", 16, 16);
  put_depth("depth/1.png", 16, 16);
  EXPECT_THAT(read_error(1), HasSubstr("rgb/1.png: frame 1 is 16x16 but camera 'small' is 32x24"));
}

TEST_F(TumSequenceTest, WrongType) {
  fs::copy_file(folder_ / "rgb/0.png", folder_ / "depth/0.png",
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(read_error(0),
              HasSubstr("depth/0.png: is a colour PNG of 8 bits a channel; a depth image is"));
  write("depth/1.png", "\x76\x2f\x31\x01");
  EXPECT_THAT(read_error(1), HasSubstr("depth/1.png: is an OpenEXR image; a depth image is"));
  write("rgb/2.png", "<html>404</html>");
  EXPECT_THAT(read_error(2), HasSubstr("rgb/2.png: is a web page (a download that failed?)"));
}

TEST_F(TumSequenceTest, SizesAreComparedBeforeAnythingIsDecoded) {
  const auto damage = [&](const std::string& name) {  // found by decoding alone
    std::fstream file(folder_ / name, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(45);
    file.put('?');
  };
  damage("rgb/0.png");
  EXPECT_THAT(read_error(0), HasSubstr("rgb/0.png: is damaged"));
  put_colour("rgb/1.png", 16, 16);
  put_depth("depth/1.png", 16, 16);
  damage("rgb/1.png");
  EXPECT_THAT(read_error(1), HasSubstr("rgb/1.png: frame 1 is 16x16 but camera 'small' is 32x24"));
  put_depth("depth/2.png", 16, 16);
  damage("depth/2.png");
  EXPECT_THAT(read_error(2), HasSubstr("depth/2.png: frame 2 is 16x16 but its colour image is"));
}

TEST_F(TumSequenceTest, FrameSourceDeliversInOrderAndGoesOnAfterABadFrame) {
  truncate("rgb/1.png", 3);
  for (const int workers : {0, 1, 2}) {
    FrameSource source(*open_sequence(folder_), small_camera(), {.depth = 2, .workers = workers});
    EXPECT_EQ(source.sequence().size(), 3U);
    EXPECT_EQ((*source.next())->index, 0);
    EXPECT_THAT(source.next()->error().message, HasSubstr("rgb/1.png: is truncated"));
    EXPECT_EQ((*source.next())->index, 2);
    EXPECT_FALSE(source.next());
  }
}

TEST_F(TumSequenceTest, FrameSourceMayGoEarly) {
  FrameSource source(*open_sequence(folder_), small_camera(), {.depth = 1, .workers = 2});
  EXPECT_TRUE(source.next()->ok());
}

/// Every frame of the recordings at hand.
class RecordedSequences : public testing::TestWithParam<const char*> {};

TEST_P(RecordedSequences, CanBeRead) {
  const char* const data = std::getenv("YDD_DATA");
  if (!data) GTEST_SKIP() << "set YDD_DATA to the folder that holds the recordings";
  const fs::path folder = fs::path(data) / GetParam();
  const auto camera = find_camera(folder);
  ASSERT_TRUE(camera) << camera.error().message;
  auto sequence = open_sequence(folder);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_GE(sequence->size(), 49U);
  ASSERT_TRUE(sequence->groundtruth());
  EXPECT_TRUE(sequence->groundtruth()->read());
  for (std::size_t i = 0; i < sequence->size(); i += 10) {
    const auto frame = sequence->read(i, *camera);
    ASSERT_TRUE(frame) << frame.error().message;
    const float* const depth_m = frame->depth_m.data();
    const auto valid = std::count_if(depth_m, depth_m + 640 * 480,
                                     [&](float d) { return camera->is_valid_depth(d); });
    EXPECT_GT(valid, 640 * 480 / 3) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Recorded, RecordedSequences,
                         testing::Values("tum_fr1_xyz", "tum_fr3_walking_halfsphere", "crowd_xyz"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace ydd
