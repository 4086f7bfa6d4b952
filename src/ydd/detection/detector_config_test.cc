// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/detector_config.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kNetwork =
    "networks:\n"
    "  spots:\n"
    "    model: spotter.onnx\n"
    "    classes: colours.yaml\n"
    "    input: {width: 128, height: 96}\n";

class DetectorFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("ydd_detector_{}_{}", ::getpid(),
                          testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    testing_onnx::write(folder_ / "spotter.onnx", testing_onnx::colour_spotter_model());
    write("colours.yaml", "names: [person, head, hand]");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string failure_of(const std::string& yaml, const std::vector<std::string>& set = {}) const {
    testing::internal::CaptureStderr();
    const auto detector = make_detector(write("detector.yaml", yaml), set);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    std::string message = detector ? "no failure" : detector.error().message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message;
  }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// Black, with a patch that the colour spotter sees as its class number `channel`: surely, or with
/// half the value by half.
RgbdFrame patch(std::size_t channel, std::uint8_t value = 255) {
  std::vector<Bgr> pixels(std::size_t{128} * 96);
  for (int y = 40; y < 48; ++y) {
    for (int x = 40; x < 48; ++x) pixels[static_cast<std::size_t>(y) * 128 + x][channel] = value;
  }
  RgbdFrame frame;
  frame.colour = ColourImage(128, 96, std::move(pixels));
  return frame;
}

TEST_F(DetectorFile, BuildsAWorkingDetector) {
  const auto file = write("detector.yaml", kNetwork + "    rename: {head: face}\n");
  const auto detector = make_detector(file);
  ASSERT_TRUE(detector.ok()) << detector.error().message;
  const auto person = (*detector)->detect(patch(0));
  ASSERT_TRUE(person.ok()) << person.error().message;
  ASSERT_EQ(person->size(), 1U);
  EXPECT_EQ(person->at(0).class_name, "person");
  EXPECT_EQ((*detector)->detect(patch(1))->at(0).class_name, "face");
  EXPECT_TRUE((*detector)->detect(patch(2))->empty()) << "a lone hand";
}

TEST_F(DetectorFile, KeepAndThresholdsActByClass) {
  const auto file = write("detector.yaml", kNetwork +
                                               "    keep: [head]\n"
                                               "    class_thresholds: {head: 0.9}\n");
  const auto detector = make_detector(file);
  ASSERT_TRUE(detector.ok()) << detector.error().message;
  EXPECT_TRUE((*detector)->detect(patch(0))->empty());
  EXPECT_EQ((*detector)->detect(patch(1))->size(), 1U);
}

TEST_F(DetectorFile, WeakOnesOfAClassAreNotSure) {
  const auto detector =
      make_detector(write("detector.yaml", kNetwork + "    keep: [person, head]\n"
                                                      "    sure_thresholds: {head: 0.7}\n"));
  ASSERT_TRUE(detector.ok()) << detector.error().message;
  const auto is_sure = [&](std::size_t channel, std::uint8_t value) {
    const auto found = (*detector)->detect(patch(channel, value));
    EXPECT_EQ(found->size(), 1U) << "it is told all the same";
    return found->at(0).sure;
  };
  EXPECT_TRUE(is_sure(1, 255));
  EXPECT_FALSE(is_sure(1, 140));
  EXPECT_TRUE(is_sure(0, 140)) << "a class without a threshold is always";
}

TEST_F(DetectorFile, ReadsEveryPartAndWritesItBack) {
  const std::string text =
      "models: weights\n"
      "networks:\n"
      "  a:\n"
      "    model: a.onnx\n"
      "    classes: a.yaml\n"
      "    kind: yolov8\n"
      "    backend: opencv\n"
      "    device: cuda\n"
      "    precision: float16\n"
      "    threads: 2\n"
      "    input: {width: 320, height: 256, channels: bgr, values: byte}\n"
      "    score_threshold: 0.2\n"
      "    nms_iou: 0.6\n"
      "    rename: {tv: monitor}\n"
      "    class_thresholds: {person: 0.15}\n"
      "    sure_thresholds: {person: 0.7}\n"
      "    ranges: [1, 22.7]\n"
      "    keep: [person, tv]\n"
      "  b: {model: b.onnx, classes: b.yaml}\n"
      "merge: {hand_reach_heads: 2.5}\n";
  auto config = read_detector_config(write("detector.yaml", text));
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(config.ok()) << config.error().message;
    ASSERT_EQ(config->networks.size(), 2U);
    const NetworkConfig& a = config->networks[0];
    EXPECT_EQ(a.name, "a");
    EXPECT_EQ(a.model, "a.onnx");
    EXPECT_EQ(a.class_table, "a.yaml");
    EXPECT_EQ(a.kind, "yolov8");
    EXPECT_EQ(a.inference.backend, Backend::opencv);
    EXPECT_EQ(a.inference.device, Device::cuda);
    EXPECT_EQ(a.inference.precision, Precision::float16);
    EXPECT_EQ(a.inference.threads, 2);
    EXPECT_EQ(a.input_width_px, 320);
    EXPECT_EQ(a.input_height_px, 256);
    EXPECT_EQ(a.channel_order, ChannelOrder::bgr);
    EXPECT_EQ(a.values, PixelValues::byte);
    EXPECT_EQ(a.score_threshold, 0.2);
    EXPECT_EQ(a.nms_iou, 0.6);
    EXPECT_EQ(a.rename.at("tv"), "monitor");
    EXPECT_EQ(a.class_thresholds.at("person"), 0.15);
    EXPECT_EQ(a.sure_thresholds.at("person"), 0.7);
    EXPECT_EQ(a.inference.ranges, (std::vector<float>{1.0F, 22.7F}));
    EXPECT_THAT(a.keep, ElementsAre("person", "tv"));
    EXPECT_EQ(config->networks[1].model, "b.onnx");
    EXPECT_EQ(config->networks[1].input_width_px, 640);
    EXPECT_EQ(config->models, "weights");
    EXPECT_EQ(config->merge.hand_reach_heads, 2.5);
    config = read_detector_config(write("again.yaml", to_yaml(*config)));
  }
}

TEST_F(DetectorFile, TheCommandLineWins) {
  const auto file = write("detector.yaml", kNetwork + "  more: {model: m.onnx, classes: c.yaml}\n");
  const std::vector<std::string> set = {"networks.*.input.width=320", "networks.more.threads=2",
                                        "merge.enabled=false"};
  const auto config = read_detector_config(file, set);
  ASSERT_TRUE(config.ok()) << config.error().message;
  EXPECT_EQ(config->networks[0].input_width_px, 320);
  EXPECT_EQ(config->networks[1].input_width_px, 320);
  EXPECT_EQ(config->networks[0].inference.threads, 1);
  EXPECT_EQ(config->networks[1].inference.threads, 2);
  EXPECT_FALSE(config->merge.enabled);
}

TEST_F(DetectorFile, MistakesInTheFileAreNamedWithTheirLine) {
  EXPECT_THAT(failure_of("networks: []\n"), HasSubstr("detector.yaml: must hold 'networks:"));
  EXPECT_THAT(failure_of(""), HasSubstr("must hold 'networks:"));
  EXPECT_THAT(failure_of("networks: {a: b.onnx}"), HasSubstr(":1: network 'a' must hold"));
  EXPECT_THAT(failure_of("networks: {a: {classes: c.yaml}}"),
              HasSubstr("networks.a.model is missing"));
  EXPECT_THAT(failure_of("networks: {a: {model: c.onnx}}"),
              HasSubstr("networks.a.classes is missing"));
  EXPECT_THAT(failure_of(kNetwork + "    sise: 3\n"), HasSubstr("detector.yaml:6: unknown option"));
  EXPECT_THAT(failure_of(kNetwork + "    score_threshold: 3\n"), HasSubstr("yaml:6: "));
  EXPECT_THAT(failure_of(kNetwork + "    kind: yolo9000\n"),
              HasSubstr("must be one of auto, yolov5"));
  EXPECT_THAT(failure_of(kNetwork + "    rename: tv\n"), HasSubstr(":6: 'rename' must be"));
  for (const std::string key : {"class_thresholds", "sure_thresholds"}) {
    EXPECT_THAT(failure_of(kNetwork + "    " + key + ": {person: 7}\n"),
                HasSubstr(":6: '" + key + "' must be"));
  }
  for (const char* ranges : {"7", "[1, 0]", "[.nan]", "[one]", "{a: 1}"}) {
    EXPECT_THAT(failure_of(kNetwork + "    ranges: " + ranges + "\n"),
                HasSubstr(":6: 'ranges' must be"));
  }
  EXPECT_THAT(failure_of(kNetwork + "    keep: person\n"), HasSubstr(":6: 'keep' must be"));
  EXPECT_THAT(failure_of(kNetwork + "merge: {x: 1}\n"), HasSubstr(":6: unknown option 'merge.x'"));
  EXPECT_THAT(failure_of("networks: {a: ["), HasSubstr("not valid YAML"));
  EXPECT_THAT(failure_of(kNetwork, {"networks.spots.input.width=100"}),
              HasSubstr("input.width is 100 but must be a multiple of 32"));
  EXPECT_THAT(failure_of(kNetwork, {"networks.none.threads=2"}),
              HasSubstr("--set: unknown option"));
}

TEST_F(DetectorFile, AMissingModelTellsWhereItWasLookedFor) {
  const std::string message = failure_of("networks: {a: {model: no.onnx, classes: colours.yaml}}");
  EXPECT_THAT(message, HasSubstr("networks.a.model: there is no file"));
  EXPECT_THAT(message, HasSubstr((folder() / "no.onnx").string()));
  EXPECT_THAT(message, HasSubstr("YDD_MODELS"));
}

TEST_F(DetectorFile, ModelsAreFoundInTheFolderOfTheOption) {
  std::filesystem::create_directories(folder() / "weights");
  std::filesystem::rename(folder() / "spotter.onnx", folder() / "weights/spotter.onnx");
  EXPECT_THAT(failure_of(kNetwork), HasSubstr("there is no file"));
  EXPECT_EQ(failure_of("models: weights\n" + kNetwork), "no failure");
}

TEST_F(DetectorFile, ATruncatedModelIsNamed) {
  const std::string whole = testing_onnx::colour_spotter_model();
  testing_onnx::write(folder() / "spotter.onnx", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(failure_of(kNetwork), HasSubstr("spotter.onnx: truncated"));
}

TEST_F(DetectorFile, ANetworkOfAnotherKindIsNamed) {
  testing_onnx::write(folder() / "spotter.onnx", testing_onnx::single_operator_model("Relu"));
  const std::string message = failure_of(kNetwork);
  EXPECT_THAT(message, HasSubstr("spotter.onnx: gives [1, 3, 96, 128]"));
  EXPECT_THAT(message, HasSubstr("not a known kind of YOLO network"));
}

TEST_F(DetectorFile, AClassTableThatDoesNotFitIsNamed) {
  write("colours.yaml", "names: [person, head]");
  EXPECT_THAT(failure_of(kNetwork),
              HasSubstr("spotter.onnx: is a yolox_heads network of 3 classes, but its class"));
  write("colours.yaml", "names: [azure, emerald, scarlet]");
  EXPECT_THAT(failure_of(kNetwork),
              HasSubstr("colours.yaml: none of its 3 classes ('azure', ...) is in the object"));
  EXPECT_EQ(failure_of(kNetwork + "    rename: {azure: person}\n"), "no failure");
  EXPECT_THAT(failure_of(kNetwork + "    rename: {crimson: person}\n"),
              HasSubstr("rename names 'crimson', which is not in the class table colours.yaml"));
  EXPECT_THAT(failure_of(kNetwork + "    keep: [crimson]\n"), HasSubstr("keep names 'crimson'"));
}

/// The weights that the project's own configurations name; they are not part of the project.
bool find_weights() {
  if (std::getenv("YDD_MODELS") != nullptr) return true;
  const char* data = std::getenv("YDD_DATA");
  if (data == nullptr) return false;
  const auto models = std::filesystem::path(data).parent_path() / "models";
  if (!std::filesystem::is_directory(models)) return false;
  // One thread only here.
  return ::setenv("YDD_MODELS", models.c_str(), 0) == 0;  // NOLINT(concurrency-mt-unsafe)
}

TEST(ProjectDetectors, AllFilesAreUnderstood) {
  for (const char* name : {"coco_body_head_hand.yaml", "yolov5n_coco.yaml"}) {
    const auto config =
        read_detector_config(std::filesystem::path(YDD_SOURCE_DIR "/configs/detector") / name);
    ASSERT_TRUE(config.ok()) << config.error().message;
  }
}

TEST(ProjectDetectors, LoadTheirWeightsAndSeeNothingInGrey) {
  if (!find_weights()) GTEST_SKIP() << "set YDD_MODELS to the folder with the network weights";
  RgbdFrame grey;
  grey.colour = ColourImage(640, 480, std::vector<Bgr>(std::size_t{640} * 480, {99, 99, 99}));
  for (const char* name : {"coco_body_head_hand.yaml", "yolov5n_coco.yaml"}) {
    const auto detector =
        make_detector(std::filesystem::path(YDD_SOURCE_DIR "/configs/detector") / name);
    ASSERT_TRUE(detector.ok()) << detector.error().message;
    EXPECT_TRUE((*detector)->detect(grey)->empty());
  }
}

TEST(ProjectDetectors, ANetworkOfOneSizeSaysSo) {
  if (!find_weights()) GTEST_SKIP() << "set YDD_MODELS to the folder with the network weights";
  const std::vector<std::string> smaller = {"networks.*.input.width=320"};
  const auto detector =
      make_detector(YDD_SOURCE_DIR "/configs/detector/yolov5n_coco.yaml", smaller);
  ASSERT_FALSE(detector.ok());
  EXPECT_THAT(detector.error().message, HasSubstr("exported for one size"));
}

}  // namespace
}  // namespace ydd
