// SPDX-License-Identifier: Apache-2.0
//
// Bags of every format as recordings: those of ROS 1's own library, and written ones.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/bags/bags_testing.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/messages/ros_writing.h"
#include "ydd/messages/wire_testing.h"
#include "ydd/sources/bag_topics.h"
#include "ydd/sources/source.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;
using bags::WrittenMessages;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

fs::path real_bag() { return fs::path(YDD_SOURCE_DIR) / "tests/data/bags/ros1_none.bag"; }

TEST(RealBagSource, IsReadWithTheTopicsThatAreBest) {
  testing::internal::CaptureStderr();
  const auto sequence = open_sequence(real_bag());
  ASSERT_TRUE(sequence) << sequence.error().message;
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_EQ(sequence->recording().source, "bag");
  EXPECT_EQ(sequence->name(), "ros1_none");
  EXPECT_THAT(log, HasSubstr("colour /camera/rgb/image_color, depth "
                             "/camera/depth_registered/image_raw"));
  EXPECT_THAT(log, HasSubstr("received 1900 s later than their headers say"));
  ASSERT_EQ(sequence->size(), 3U);
  EXPECT_EQ(sequence->entry(2).stamp.ns, 100'200'000'000);
  EXPECT_EQ(sequence->entry(2).depth_stamp.ns, 100'205'000'000);
  const auto camera = find_camera(sequence->recording());
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->fx_px, 41);
  EXPECT_EQ(camera->k3, 0.5);
  EXPECT_EQ(camera->fps, 10);
  const auto frame = sequence->read(2, *camera);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->colour(5, 5), (Bgr{12, 20, 200}));
  EXPECT_FLOAT_EQ(frame->depth_m(5, 5), 1.2F);
  EXPECT_EQ(frame->depth_m(0, 5), 0.0F);
}

TEST(RealBagSource, EveryOtherTopicByItsName) {
  for (const char* const depth : {"/metric/depth/image", "/metric/depth/image/compressedDepth",
                                  "/camera/depth_registered/image_raw"}) {
    const auto sequence = open_sequence(
        real_bag(), {.topic_colour = "/camera/rgb/image_color/compressed", .topic_depth = depth});
    ASSERT_TRUE(sequence) << sequence.error().message;
    const auto frame = sequence->read(1, find_camera(sequence->recording()).value());
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_NEAR(frame->depth_m(5, 5), 1.1, 1e-3) << depth;
    EXPECT_EQ(frame->depth_m(0, 5), 0.0F) << depth;
    EXPECT_NEAR(frame->colour(5, 5)[2], 200, 4);
  }
}

TEST(RealBagSource, ATopicThatIsNotThereOrNotThat) {
  const auto error_of = [](const SequenceOptions& options) {
    const auto sequence = open_sequence(real_bag(), options);
    if (!sequence) return sequence.error().message;
    const auto frame = sequence->read(0, find_camera(sequence->recording()).value());
    return frame ? "no error" : frame.error().message;
  };
  EXPECT_THAT(error_of({.topic_depth = "/nothing"}),
              AllOf(HasSubstr("ros1_none.bag: --topic-depth: no topic '/nothing' with pictures"),
                    HasSubstr("/camera/rgb/image_color (rgb8, 3 messages)"), Not(HasSubstr("\n"))));
  EXPECT_THAT(error_of({.topic_depth = "/camera/rgb/image_color"}),
              HasSubstr("/camera/rgb/image_color, message 0: is 'rgb8'; depth is 16UC1"));
  const auto camera =
      find_camera(open_sequence(real_bag(), {.topic_camera_info = "/no/camera_info"})->recording());
  EXPECT_THAT(camera.error().message,
              AllOf(HasSubstr("has no CameraInfo '/no/camera_info'"),
                    HasSubstr("/camera/rgb/camera_info (sensor_msgs/CameraInfo, 3 messages)"),
                    HasSubstr("--topic-camera-info")));
}

constexpr std::uint32_t kWidth = 32, kHeight = 24;

/// One of the formats with messages like those of a RealSense.
class BagSource : public testing::Test {
 protected:
  void add(const std::string& topic, const std::string& type, Timestamp stamp,
           const std::string& bytes, double received_later_s = 0) {
    const auto later_ns = static_cast<std::int64_t>(received_later_s * 1e9);
    messages_.push_back({topic, "sensor_msgs/msg/" + type, {stamp.ns + later_ns}, bytes});
  }
  void add_colour(const std::string& topic, Timestamp stamp, double received_later_s = 0) {
    const std::string rows(kHeight * kWidth * 3, '\x50');
    add(topic, "Image", stamp,
        image_message(Wire::cdr, stamp, kWidth, kHeight, "bgr8", kWidth * 3, rows),
        received_later_s);
  }
  void add_depth(const std::string& topic, Timestamp stamp) {
    std::string rows;
    for (std::uint32_t i = 0; i < kHeight * kWidth; ++i) rows += "\xD0\x07";  // 2000
    add(topic, "Image", stamp,
        image_message(Wire::cdr, stamp, kWidth, kHeight, "16UC1", kWidth * 2, rows));
  }
  void add_info(const std::string& topic, double fx = 30) {
    add(topic, "CameraInfo", at(0),
        camera_info_message(Wire::cdr, at(0), kWidth, kHeight, fx, fx, 16, 12));
  }
  static Timestamp at(int frame) { return {1'700'000'000'000'000'000 + frame * 33'333'333LL}; }

  void add_all() {
    for (int i = 0; i < 3; ++i) {
      add_colour("/camera/color/image_raw", at(i));
      add_depth("/camera/aligned_depth_to_color/image_raw", at(i));
    }
    add_info("/camera/color/camera_info");
  }
  Result<Sequence> open(const SequenceOptions& options = {}) {
    bags::write_sqlite_bag(folder_ / "a.db3", messages_);
    return open_sequence(folder_ / "a.db3", options);
  }
  std::string log_of_opening() {
    testing::internal::CaptureStderr();
    const auto sequence = open();
    return testing::internal::GetCapturedStderr() + (sequence ? "" : sequence.error().message);
  }

  WrittenMessages messages_;
  TemporaryFolder folder_;
};

TEST_F(BagSource, BothFormatsOfRosTwo) {
  add_all();
  bags::write_bytes(folder_ / "a.mcap", bags::mcap_bag(messages_, ""));
  bags::write_sqlite_bag(folder_ / "a.db3", messages_);
  for (const char* const name : {"a.mcap", "a.db3"}) {
    const auto sequence = open_sequence(folder_ / name);
    ASSERT_TRUE(sequence) << sequence.error().message;
    ASSERT_EQ(sequence->size(), 3U);
    const Camera camera = find_camera(sequence->recording()).value();
    const auto frame = sequence->read(1, camera);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->colour(3, 3)[0], 0x50);
    EXPECT_FLOAT_EQ(frame->depth_m(3, 3), 2.0F);
    EXPECT_EQ(camera.fps, 30);
  }
}

TEST_F(BagSource, TopicsThatAreAsGoodAreListed) {
  add_all();
  add_colour("/second/color/image_raw", at(0));
  EXPECT_THAT(log_of_opening(),
              AllOf(HasSubstr("a.db3: several topics can be colour: /camera/color/image_raw (bgr8, "
                              "3 messages), /second/color/image_raw (bgr8, 1 messages); say which "
                              "with --topic-colour"),
                    Not(HasSubstr("aligned_depth"))));
  EXPECT_TRUE(open_sequence(folder_ / "a.db3", {.topic_colour = "/camera/color/image_raw"}));
}

TEST_F(BagSource, NothingOfAKindListsWhatThereIs) {
  add_colour("/camera/color/image_raw", at(0));
  EXPECT_THAT(log_of_opening(), HasSubstr("no topic of depth pictures; topics of pictures: "
                                          "/camera/color/image_raw (bgr8, 1 messages)"));
}

TEST_F(BagSource, WithoutAnyPictureAllTopicsAreListed) {
  add("/imu", "Imu", at(0), "x");
  EXPECT_THAT(log_of_opening(), HasSubstr("no topic of colour pictures; topics: /imu "
                                          "(sensor_msgs/msg/Imu, 1 messages)"));
}

TEST_F(BagSource, RegisteredDepthIsBetterThanTheSensorsOwn) {
  for (int i = 0; i < 2; ++i) add_depth("/camera/depth/image_rect_raw", at(i));
  add_info("/camera/depth/camera_info", 20);
  add_all();
  EXPECT_THAT(log_of_opening(), HasSubstr("depth /camera/aligned_depth_to_color/image_raw"));
  std::erase_if(messages_, [](const auto& m) { return m.topic.find("aligned") != m.topic.npos; });
  fs::remove(folder_ / "a.db3");
  EXPECT_THAT(log_of_opening(),
              HasSubstr("/camera/depth/image_rect_raw is seen with fx 20.0 but colour with 30.0: "
                        "depth must be registered to colour"));
}

TEST_F(BagSource, SensorsOfMotionAreFoundByTheirType) {
  add_all();
  EXPECT_EQ(open()->recording().motion, nullptr);
  fs::remove(folder_ / "a.db3");
  ImuMessage imu;
  imu.has_turn = imu.has_acceleration = true;
  OdometryMessage wheels;
  wheels.orientation = {0, 0, 1, 0};
  for (const int i : {0, 2, 1, 1}) {  // out of order, and one twice
    imu.stamp = wheels.stamp = at(i);
    imu.turn_rad_s = {0.1 * i, 0, 0};
    imu.acceleration_m_s2 = {0, -9.8, 0};
    wheels.position_m = {0, 1.0 * i, 0};
    add("/imu", "Imu", at(i), write_imu(imu, Wire::cdr));
    messages_.push_back(
        {"/wheels", "nav_msgs/msg/Odometry", at(i), write_odometry(wheels, Wire::cdr)});
  }
  add("/imu", "Imu", at(3), "damaged, and long enough to hold a header");
  const auto sequence = open();
  ASSERT_TRUE(sequence) << sequence.error().message;
  const MotionStore& motion = *sequence->recording().motion;
  EXPECT_EQ(motion.imu_topics(), std::vector<std::string>{"/imu"});
  EXPECT_EQ(motion.odometry_topics(), std::vector<std::string>{"/wheels"});
  testing::internal::CaptureStderr();
  const std::vector<ImuSample> turned = motion.read_imu("/imu").value();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("/imu: 2 messages are damaged or"));
  ASSERT_EQ(turned.size(), 3U);
  EXPECT_EQ(turned[2].stamp, at(2));
  EXPECT_EQ(turned[2].gyro_rad_s.x(), 0.2);
  EXPECT_EQ(turned[2].accel_m_s2.y(), -9.8);
  const std::vector<OdometryPose> gone = motion.read_odometry("/wheels").value();
  ASSERT_EQ(gone.size(), 3U);
  EXPECT_EQ(gone[1].T_odom_base.translation().y(), 1);
  EXPECT_EQ(gone[1].T_odom_base.rotation().z(), 1);
}

TEST_F(BagSource, SensorsOfMotionThatCannotBeUsedAreOneLine) {
  add_all();
  ImuMessage imu;
  imu.has_turn = true;  // as a TUM recording's accelerometer, the other way round
  add("/no_acceleration", "Imu", at(0), write_imu(imu, Wire::cdr));
  imu.has_acceleration = true;
  imu.turn_rad_s = {180, 0, 0};
  add("/degrees", "Imu", at(0), write_imu(imu, Wire::cdr));
  add("/nothing", "Imu", at(0), "damaged, and long enough to hold a header");
  OdometryMessage wheels;  // its quaternion is 0
  messages_.push_back({"/odom", "nav_msgs/msg/Odometry", at(0), write_odometry(wheels, Wire::cdr)});
  const auto sequence = open();
  const MotionStore& motion = *sequence->recording().motion;
  const auto error = [&](const std::string& topic) {
    return motion.read_imu(topic).error().message;
  };
  EXPECT_THAT(error("/no_acceleration"), HasSubstr("measures no acceleration"));
  EXPECT_THAT(error("/degrees"),
              HasSubstr("/degrees, message 0: has a reading that no such sensor gives"));
  EXPECT_THAT(error("/nothing"), HasSubstr("has no message that can be read"));
  EXPECT_THAT(motion.read_odometry("/odom").error().message, HasSubstr("has a pose that is none"));
}

TEST_F(BagSource, TheOrderIsThatOfTheHeaders) {
  add_all();
  std::swap(messages_[0].bytes, messages_[4].bytes);
  messages_.push_back(messages_[2]);  // the same once more
  messages_.back().received = at(9);
  const std::string log = log_of_opening();
  EXPECT_THAT(log, HasSubstr("/camera/color/image_raw: 1 of 4 messages have the stamp of another"));
  const auto sequence = open_sequence(folder_ / "a.db3");
  ASSERT_EQ(sequence->size(), 3U);
  EXPECT_EQ(sequence->entry(0).stamp, at(0));
}

TEST_F(BagSource, HeadersWithoutAStampLeaveTheTimesOfReceiving) {
  for (int i = 0; i < 3; ++i) {
    add_colour("/rgb/image", {0}, at(i).seconds());
    add_depth("/depth/image", at(i));
  }
  add_info("/rgb/camera_info");
  EXPECT_THAT(log_of_opening(), HasSubstr("/rgb/image: all headers have the stamp 0.000000000; the "
                                          "times at which messages were received are used"));
  EXPECT_EQ(open_sequence(folder_ / "a.db3", {.max_difference_s = 0.03})->size(), 3U);
}

TEST_F(BagSource, OneThatIsCutOffIsReadUpToThereWithAWarning) {
  add_all();
  add_all();
  std::string text = bags::mcap_bag(messages_, "no chunks");
  text.resize(text.size() * 7 / 10);
  bags::write_bytes(folder_ / "cut.mcap", text);
  testing::internal::CaptureStderr();
  const auto sequence = open_sequence(folder_ / "cut.mcap");
  const std::string log = testing::internal::GetCapturedStderr();
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->size(), 3U);
  EXPECT_THAT(log, HasSubstr("cut.mcap: is cut off or damaged at byte"));
  text.resize(300);
  bags::write_bytes(folder_ / "cut.mcap", text);
  EXPECT_THAT(open_sequence(folder_ / "cut.mcap").error().message,
              AllOf(HasSubstr("cut.mcap: is cut off"), HasSubstr("no topic of colour pictures")));
}

TEST_F(BagSource, WithoutCalibrationTheOptionsAreNamed) {
  add_all();
  messages_.pop_back();
  const auto sequence = open();
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_THAT(find_camera(sequence->recording()).error().message,
              AllOf(HasSubstr("a.db3: has no CameraInfo '/camera/color/camera_info' (there are: "
                              "none)"),
                    HasSubstr("--topic-camera-info, or give --camera")));
  const Camera preset = find_camera(sequence->recording(), "tum_fr1").value();
  EXPECT_EQ(preset.name, "tum_fr1");
  EXPECT_EQ(preset.depth_scale, 1000) << "counts of ROS are millimetres";
}

// --- which topic --------------------------------------------------------------------------------

TopicSeen picture(const std::string& name, PictureUse use, MessageKind kind = MessageKind::image) {
  return {name, "sensor_msgs/Image", kind, {use, "x"}, 10};
}
TopicSeen info(const std::string& name) {
  return {name, "sensor_msgs/CameraInfo", MessageKind::camera_info, {}, 10};
}
std::string chosen(const std::vector<TopicSeen>& topics, PictureUse use,
                   const std::string& asked = "") {
  const auto topic = choose_topic(topics, use, asked, "--topic");
  return topic ? topics[*topic].name : topic.error().message;
}

TEST(BagTopics, ThoseOfUsualDrivers) {
  const std::vector<TopicSeen> realsense = {
      picture("/camera/infra1/image_rect_raw", PictureUse::grey),
      picture("/camera/color/image_raw", PictureUse::colour),
      picture("/camera/color/image_raw/compressed", PictureUse::colour,
              MessageKind::compressed_image),
      picture("/camera/depth/image_rect_raw", PictureUse::depth),
      picture("/camera/aligned_depth_to_color/image_raw", PictureUse::depth)};
  EXPECT_EQ(chosen(realsense, PictureUse::colour), "/camera/color/image_raw");
  EXPECT_EQ(chosen(realsense, PictureUse::depth), "/camera/aligned_depth_to_color/image_raw");
  const std::vector<TopicSeen> openni = {
      picture("/camera/ir/image", PictureUse::grey),
      picture("/camera/rgb/image_rect_color/compressed", PictureUse::colour,
              MessageKind::compressed_image),
      picture("/camera/depth_registered/image_raw/compressedDepth", PictureUse::depth,
              MessageKind::compressed_image),
      picture("/camera/depth/image_raw", PictureUse::depth),
      picture("/people/debug_image", PictureUse::colour)};
  EXPECT_EQ(chosen(openni, PictureUse::colour), "/camera/rgb/image_rect_color/compressed");
  EXPECT_EQ(chosen(openni, PictureUse::depth),
            "/camera/depth_registered/image_raw/compressedDepth");
}

TEST(BagTopics, AnAskedOneMayLackItsTransport) {
  const std::vector<TopicSeen> topics = {
      picture("/a", PictureUse::colour), picture("/b", PictureUse::colour),
      picture("/c/compressed", PictureUse::colour, MessageKind::compressed_image)};
  EXPECT_EQ(chosen(topics, PictureUse::colour, "/b"), "/b");
  EXPECT_EQ(chosen(topics, PictureUse::colour, "/c"), "/c/compressed");
  EXPECT_THAT(chosen(topics, PictureUse::colour, "/d"), HasSubstr("--topic: no topic '/d'"));
  EXPECT_THAT(chosen(topics, PictureUse::colour), HasSubstr("several topics can be colour: /a "));
}

TEST(BagTopics, TheCamera) {
  EXPECT_EQ(camera_info_of("/camera/color/image_raw"), "/camera/color/camera_info");
  EXPECT_EQ(camera_info_of("/camera/color/image_raw/compressed"), "/camera/color/camera_info");
  EXPECT_EQ(camera_info_of("image"), "/camera_info");
  const std::vector<TopicSeen> topics = {picture("/rgb/image", PictureUse::colour),
                                         picture("/depth_registered/image", PictureUse::depth),
                                         picture("/depth/image", PictureUse::depth),
                                         info("/depth_registered/camera_info"),
                                         info("/depth/camera_info")};
  EXPECT_EQ(choose_camera_info(topics, 0, 1, "").value(), 3U) << "registered: seen by colour";
  EXPECT_FALSE(choose_camera_info(topics, 0, 2, ""));
  EXPECT_EQ(choose_camera_info(topics, 0, 2, "/depth/camera_info").value(), 4U);
}

}  // namespace
}  // namespace ydd::sources
