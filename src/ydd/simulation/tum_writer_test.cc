// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/tum_writer.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/sources/source.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TumWriter : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("tum_writer_") +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    options_.width_px = 160;
    options_.height_px = 120;
    options_.frames = 3;
    options_.people = 1;
    options_.path = PathKind::stationary;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
  WorldOptions options_;
};

TEST_F(TumWriter, WritesWhatTheReaderReads) {
  const Simulator simulator(options_);
  TumWriterOptions writing;
  writing.jobs = 2;
  int done = 0;
  writing.progress = [&](int frames) { done = frames; };
  const fs::path out = folder_ / "sequence";
  const Result<void> written = write_tum_sequence(simulator, out, writing);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(done, 3);

  const Result<Sequence> sequence = open_sequence(out);
  ASSERT_TRUE(sequence) << sequence.error().message;
  ASSERT_EQ(sequence->size(), 3U);
  const Result<Camera> camera = find_camera(out);
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->fx_px, simulator.camera().fx_px);
  const Result<StampedPoses> truth = read_tum_trajectory(out / "groundtruth.txt");
  ASSERT_TRUE(truth) << truth.error().message;
  const Result<DetectionRecording> boxes = DetectionRecording::read(out / "detections.jsonl");
  ASSERT_TRUE(boxes) << boxes.error().message;
  for (int i = 0; i < 3; ++i) {
    const Result<RgbdFrame> read = sequence->read(static_cast<std::size_t>(i), *camera);
    ASSERT_TRUE(read) << read.error().message;
    const SimulatedFrame made = simulator.render(i);
    EXPECT_EQ(read->stamp, made.frame.stamp);
    for (int k = 0; k < 160 * 120; ++k) {
      ASSERT_EQ(read->colour.data()[k], made.frame.colour.data()[k]);
      ASSERT_NEAR(read->depth_m.data()[k], made.frame.depth_m.data()[k], 1.01e-4);
    }
    EXPECT_LT(((*truth)[i].T_world_camera.inverse() * made.T_world_camera).log().norm(), 1e-8);
    const RecordedFrame* recorded = boxes->find(made.frame.stamp, 1e-6);
    ASSERT_NE(recorded, nullptr);
    ASSERT_EQ(recorded->detections.size(), made.objects.size());
    EXPECT_EQ(recorded->detections[0].detection.box, made.objects[0].box);
    EXPECT_EQ(recorded->detections[0].id, made.objects[0].id);
  }
  EXPECT_FALSE(fs::exists(folder_ / "sequence.part"));
}

TEST_F(TumWriter, WritesJpegToo) {
  options_.frames = 1;
  TumWriterOptions writing;
  writing.colour_format = ColourFormat::jpeg;
  const fs::path out = folder_ / "sequence";
  ASSERT_TRUE(write_tum_sequence(Simulator(options_), out, writing));
  EXPECT_TRUE(fs::exists(out / "rgb" / "1700000000.000000.jpg"));
  EXPECT_TRUE(fs::exists(out / "mask" / "1700000000.000000.png"));
  EXPECT_TRUE(open_sequence(out));
}

TEST_F(TumWriter, LeavesAnExistingFolderAlone) {
  const Simulator simulator(options_);
  const Result<void> refused = write_tum_sequence(simulator, folder_, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("exists already"));
}

TEST_F(TumWriter, NamesTheFolderThatCannotBeWritten) {
  const fs::path file = folder_ / "file";
  std::ofstream(file) << "not a folder";
  const Result<void> refused = write_tum_sequence(Simulator(options_), file / "below", {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("below"));
}

}  // namespace
}  // namespace ydd
