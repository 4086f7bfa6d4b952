// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/yolo_detector.h"

#include <unistd.h>

#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

using testing::HasSubstr;

constexpr Bgr kBlue{255, 0, 0};
constexpr Bgr kGreen{0, 255, 0};
constexpr Bgr kRed{0, 0, 255};

struct Patch {
  int x0, y0, size;
  Bgr colour;
};

RgbdFrame picture(int width_px, int height_px, const std::vector<Patch>& patches) {
  std::vector<Bgr> pixels(static_cast<std::size_t>(width_px) * height_px);
  for (const Patch& p : patches) {
    for (int y = p.y0; y < p.y0 + p.size; ++y) {
      for (int x = p.x0; x < p.x0 + p.size; ++x) {
        pixels[static_cast<std::size_t>(y) * width_px + x] = p.colour;
      }
    }
  }
  RgbdFrame frame;
  frame.index = 7;
  frame.colour = ColourImage(width_px, height_px, std::move(pixels));
  return frame;
}

std::unique_ptr<InferenceSession> session_of(const std::string& model) {
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("ydd_yolo_detector_{}.onnx", ::getpid());
  testing_onnx::write(file, model);
  auto session = load_network(file, {});
  std::filesystem::remove(file);
  if (!session) throw std::runtime_error(session.error().message);
  return std::move(session).value();
}

YoloSettings colours(int width_px = 128, int height_px = 96) {
  YoloSettings settings;
  settings.classes = {{"blue", 0.7F}, {"green", 0.7F}, {"red", 0.7F}};
  settings.input_width_px = width_px;
  settings.input_height_px = height_px;
  return settings;
}

std::unique_ptr<YoloDetector> colour_spotter(const YoloSettings& settings) {
  auto detector = YoloDetector::make(session_of(testing_onnx::colour_spotter_model()), settings);
  if (!detector) throw std::runtime_error(detector.error().message);
  return std::move(detector).value();
}

TEST(YoloDetector, FindsPatchesWithTheirClassAndPlace) {
  const auto detector = colour_spotter(colours());
  EXPECT_EQ(detector->kind(), YoloKind::yolox_heads) << "recognised";
  const auto found = detector->detect(picture(128, 96, {{40, 32, 8, kRed}, {80, 48, 8, kBlue}}));
  ASSERT_TRUE(found.ok()) << found.error().message;
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].class_name, "red");
  EXPECT_FLOAT_EQ((*found)[0].score, 1.0F);
  EXPECT_NEAR((*found)[0].box.x0, 28, 1e-3);
  EXPECT_NEAR((*found)[0].box.y0, 20, 1e-3);
  EXPECT_NEAR((*found)[0].box.x1, 60, 1e-3);
  EXPECT_NEAR((*found)[0].box.y1, 52, 1e-3);
  EXPECT_EQ((*found)[1].class_name, "blue");
}

/// Says the same to every picture.
class Parrot : public InferenceSession {
 public:
  explicit Parrot(std::vector<float> row) : values_(std::move(row)) {}
  Result<std::vector<Tensor>> run(const Tensor&) override {
    return std::vector<Tensor>{{{1, 1, 6}, values_}};
  }

 private:
  std::vector<float> values_;
};

TEST(YoloDetector, AClassThatTheTableLacksIsAnError) {
  auto detector = YoloDetector::make(
      std::make_unique<Parrot>(std::vector<float>{8, 8, 40, 40, 0.9F, 3}), colours());
  ASSERT_TRUE(detector.ok()) << detector.error().message;
  EXPECT_EQ((*detector)->kind(), YoloKind::end_to_end);
  const auto found = (*detector)->detect(picture(128, 96, {}));
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.error().message,
              HasSubstr("class 3 (counted from 0), but its class table has 3"));
}

TEST(YoloDetector, GivesBoxesInPixelsOfTheImageWhateverTheInputSize) {
  // Half the size, 16 rows of margin above: the patch is seen at (20, 16 + 16).
  const auto detector = colour_spotter(colours(64, 96));
  const auto found = detector->detect(picture(128, 128, {{32, 32, 16, kGreen}}));
  ASSERT_TRUE(found.ok());
  ASSERT_EQ(found->size(), 1U) << "nothing in the grey margin";
  EXPECT_EQ((*found)[0].class_name, "green");
  EXPECT_NEAR((*found)[0].box.x0, 40 - 32, 1e-3);
  EXPECT_NEAR((*found)[0].box.y0, 40 - 32, 1e-3);
  EXPECT_NEAR((*found)[0].box.x1, 40 + 32, 1e-3);
}

TEST(YoloDetector, CutsBoxesToTheImageAndSuppressesDuplicates) {
  const auto detector = colour_spotter(colours());
  const auto found = detector->detect(picture(128, 96, {{0, 0, 16, kRed}}));
  ASSERT_TRUE(found.ok());
  // Four cells see the patch, with 32 px boxes 8 px apart: neighbours overlap by 0.6, those across
  // by 0.39.
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].box, (Box{0, 0, 20, 20}));
}

TEST(YoloDetector, ThresholdsAreByClassAndUnnamedClassesAreIgnored) {
  YoloSettings settings = colours();
  settings.classes = {{"blue", 0.2F}, {"", 0.0F}, {"red", 0.9F}};
  const auto detector = colour_spotter(settings);
  const auto found = detector->detect(picture(128, 96,
                                              {{40, 32, 8, {128, 0, 0}},
                                               {40, 72, 8, kGreen},
                                               {80, 48, 8, {0, 0, 128}},
                                               {104, 16, 8, kRed}}));
  ASSERT_TRUE(found.ok());
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].class_name, "red");
  EXPECT_EQ((*found)[0].score, 1.0F);
  EXPECT_EQ((*found)[1].class_name, "blue");
}

TEST(YoloDetector, TheChannelOrderCanBeSet) {
  YoloSettings settings = colours();
  settings.rgb = true;
  const auto found = colour_spotter(settings)->detect(picture(128, 96, {{40, 32, 8, kRed}}));
  ASSERT_TRUE(found.ok());
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ((*found)[0].class_name, "blue");
}

TEST(YoloDetector, ANetworkOfAnotherKindIsFoundBeforeTheFirstFrame) {
  const auto other =
      YoloDetector::make(session_of(testing_onnx::single_operator_model("Relu")), colours());
  ASSERT_FALSE(other.ok());
  EXPECT_THAT(other.error().message, HasSubstr("gives [1, 3, 96, 128] for 3 classes"));
  YoloSettings two_classes = colours();
  two_classes.classes.pop_back();
  EXPECT_FALSE(
      YoloDetector::make(session_of(testing_onnx::colour_spotter_model()), two_classes).ok());
  YoloSettings wrong_kind = colours();
  wrong_kind.kind = YoloKind::yolov8;
  const auto set = YoloDetector::make(session_of(testing_onnx::colour_spotter_model()), wrong_kind);
  ASSERT_FALSE(set.ok());
  EXPECT_THAT(set.error().message, HasSubstr("but 'yolov8' needs"));
}

TEST(YoloDetector, AFrameWithoutColourIsAnError) {
  const auto detector = colour_spotter(colours());
  RgbdFrame frame;
  frame.index = 3;
  const auto found = detector->detect(frame);
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.error().message, HasSubstr("frame 3 has no colour picture"));
}

TEST(YoloDetector, ImpossibleSettingsAreAProgrammingError) {
  EXPECT_THROW(colour_spotter(colours(100, 96)), std::logic_error);
  EXPECT_THROW(YoloDetector::make(nullptr, colours()).ok(), std::logic_error);
}

}  // namespace
}  // namespace ydd
