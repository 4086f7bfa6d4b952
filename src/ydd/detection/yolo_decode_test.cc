// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/yolo_decode.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::HasSubstr;

constexpr YoloShape kShape{2, 64, 96};  // two classes, 64 wide, 96 high
constexpr int kRow = 7;                 // 5 + 2
constexpr int kCells = 8 * 12 + 4 * 6 + 2 * 3;

/// A tensor that owns its values.
struct Output {
  explicit Output(std::vector<int> s, float fill = 0.0F) : shape(std::move(s)) {
    std::size_t size = 1;
    for (const int d : shape) size *= static_cast<std::size_t>(d);
    values.assign(size, fill);
  }
  /// Of a {1, channels, rows, columns} tensor.
  float& at(int channel, int y, int x) {
    return values[(static_cast<std::size_t>(channel) * shape[2] + y) * shape[3] + x];
  }
  Tensor view() const { return {shape, values}; }

  std::vector<int> shape;
  std::vector<float> values;
};

std::vector<Output> heads(int channels, float fill = 0.0F) {
  return {Output({1, channels, 12, 8}, fill), Output({1, channels, 6, 4}, fill),
          Output({1, channels, 3, 2}, fill)};
}

std::vector<Tensor> views(const std::vector<Output>& outputs) {
  std::vector<Tensor> out;
  out.reserve(outputs.size());
  for (const Output& o : outputs) out.push_back(o.view());
  return out;
}

void expect_box(const Candidate& c, float cx, float cy, float w, float h) {
  EXPECT_NEAR(c.box_input.x0, cx - w / 2, 1e-3);
  EXPECT_NEAR(c.box_input.y0, cy - h / 2, 1e-3);
  EXPECT_NEAR(c.box_input.x1, cx + w / 2, 1e-3);
  EXPECT_NEAR(c.box_input.y1, cy + h / 2, 1e-3);
}

float logit(float p) { return std::log(p / (1 - p)); }

/// Writes what YOLOv5 gives for a box: the inverse of its decoding.
void put_yolov5(Output& head, int stride, int anchor, float anchor_w, float anchor_h, float cx,
                float cy, float w, float h, float objectness, int cls, float cls_score,
                bool logits) {
  const int gx = static_cast<int>(cx) / stride;
  const int gy = static_cast<int>(cy) / stride;
  const auto s = static_cast<float>(stride);
  const auto set = [&](int k, float p) {
    head.at(anchor * kRow + k, gy, gx) = logits ? logit(p) : p;
  };
  set(0, (cx / s - static_cast<float>(gx) + 0.5F) / 2);
  set(1, (cy / s - static_cast<float>(gy) + 0.5F) / 2);
  set(2, std::sqrt(w / anchor_w) / 2);
  set(3, std::sqrt(h / anchor_h) / 2);
  set(4, objectness);
  set(5 + cls, cls_score);
}

TEST(YoloDecode, Yolov5Rows) {
  Output output({1, 3 * kCells, kRow});
  const float row[] = {30, 40, 10, 20, 0.5F, 0.2F, 0.8F};
  std::copy(std::begin(row), std::end(row), output.values.begin() + kRow * 100);
  const auto found = decode_yolo(YoloKind::yolov5, views({output}), kShape, 0.3F);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].class_index, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.4F);
  expect_box(found[0], 30, 40, 10, 20);
}

TEST(YoloDecode, Yolov8Columns) {
  Output output({1, 6, kCells});
  const float column[] = {30, 40, 10, 20, 0.7F, 0.2F};
  for (std::size_t k = 0; k < 6; ++k) output.values[k * kCells + 17] = column[k];
  const auto found = decode_yolo(YoloKind::yolov8, views({output}), kShape, 0.3F);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].class_index, 0);
  EXPECT_FLOAT_EQ(found[0].score, 0.7F);
  expect_box(found[0], 30, 40, 10, 20);
}

TEST(YoloDecode, YoloxHeadsAtEachStride) {
  auto outputs = heads(kRow);
  // Cell (x 3, y 5) of stride 8, cell (1, 2) of stride 32.
  const auto put = [](Output& head, int x, int y, std::vector<float> t) {
    for (int k = 0; k < kRow; ++k) head.at(k, y, x) = t[static_cast<std::size_t>(k)];
  };
  put(outputs[0], 3, 5, {0.25F, -0.5F, std::log(2.0F), std::log(3.0F), 0.9F, 0.1F, 1.0F});
  put(outputs[2], 1, 2, {0.5F, 0.5F, 0, std::log(0.5F), 0.8F, 0.5F, 0.25F});
  // The order of the outputs does not matter.
  const std::vector<Tensor> shuffled = {outputs[2].view(), outputs[0].view(), outputs[1].view()};
  const auto found = decode_yolo(YoloKind::yolox_heads, shuffled, kShape, 0.3F);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].class_index, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.9F);
  expect_box(found[0], 3.25F * 8, 4.5F * 8, 16, 24);
  EXPECT_EQ(found[1].class_index, 0);
  EXPECT_FLOAT_EQ(found[1].score, 0.4F);
  expect_box(found[1], 1.5F * 32, 2.5F * 32, 32, 16);
}

TEST(YoloDecode, Yolov5HeadsBeforeAndAfterTheSigmoid) {
  for (const bool logits : {false, true}) {
    auto outputs = heads(3 * kRow, logits ? -12.0F : 0.0F);
    put_yolov5(outputs[0], 8, 1, 16, 30, 45, 70, 20, 33, 0.9F, 1, 0.8F, logits);
    put_yolov5(outputs[1], 16, 2, 59, 119, 20, 50, 40, 90, 0.7F, 0, 0.9F, logits);
    put_yolov5(outputs[2], 32, 0, 116, 90, 33, 40, 60, 50, 0.6F, 0, 0.4F, logits);
    const auto kind = logits ? YoloKind::yolov5_logits : YoloKind::yolov5_heads;
    const auto found = decode_yolo(kind, views(outputs), kShape, 0.3F);
    ASSERT_EQ(found.size(), 2U) << "the third has 0.24";
    expect_box(found[0], 45, 70, 20, 33);
    EXPECT_EQ(found[0].class_index, 1);
    EXPECT_NEAR(found[0].score, 0.72F, 1e-5);
    expect_box(found[1], 20, 50, 40, 90);
    EXPECT_EQ(found[1].class_index, 0);
    EXPECT_NEAR(found[1].score, 0.63F, 1e-5);
    EXPECT_EQ(decode_yolo(kind, views(outputs), kShape, 0.2F).size(), 3U);
    EXPECT_EQ(recognise_yolo(views(outputs), kShape).value(), kind);
  }
}

TEST(YoloDecode, WhatIsNotANumberIsLeftOut) {
  auto outputs = heads(kRow);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int k = 0; k < kRow; ++k) outputs[0].at(k, 0, 0) = nan;
  outputs[0].at(2, 0, 1) = 1000;  // width overflows
  for (const int k : {4, 5}) outputs[0].at(k, 0, 1) = 1;
  outputs[0].at(0, 0, 2) = nan;
  for (const int k : {4, 5}) outputs[0].at(k, 0, 2) = 1;
  EXPECT_TRUE(decode_yolo(YoloKind::yolox_heads, views(outputs), kShape, 0.1F).empty());
}

TEST(YoloDecode, RecognisesEachKindByShape) {
  EXPECT_EQ(recognise_yolo(views({Output({1, 3 * kCells, kRow})}), kShape).value(),
            YoloKind::yolov5);
  EXPECT_EQ(recognise_yolo(views({Output({1, 6, kCells})}), kShape).value(), YoloKind::yolov8);
  EXPECT_EQ(recognise_yolo(views(heads(kRow)), kShape).value(), YoloKind::yolox_heads);
  EXPECT_EQ(recognise_yolo(views(heads(3 * kRow)), kShape).value(), YoloKind::yolov5_heads);
  auto with_heads = heads(3 * kRow);
  with_heads.emplace_back(std::vector<int>{1, 3 * kCells, kRow});
  EXPECT_EQ(recognise_yolo(views(with_heads), kShape).value(), YoloKind::yolov5);
}

TEST(YoloDecode, AnotherNetworkOrAnotherClassTableIsAnError) {
  const auto classifier = recognise_yolo(views({Output({1, 1000})}), kShape);
  ASSERT_FALSE(classifier.ok());
  EXPECT_THAT(classifier.error().message, HasSubstr("gives [1, 1000] for 2 classes at 64 x 96"));
  EXPECT_THAT(classifier.error().message, HasSubstr("not a known kind of YOLO network"));
  const auto fitting = [](const std::vector<Output>& outputs) {
    const auto kind = recognise_yolo(views(outputs), kShape);
    return kind ? "recognised" : kind.error().message;
  };
  EXPECT_EQ(fitting(heads(kRow + 1)),
            "is a yolox_heads network of 3 classes, but its class table has 2");
  EXPECT_THAT(fitting(heads(3 * kRow + 3)), HasSubstr("yolov5_heads network of 3 classes"));
  EXPECT_THAT(fitting({Output({1, 84, kCells})}), HasSubstr("yolov8 network of 80 classes"));
  EXPECT_THAT(fitting({Output({1, 3 * kCells, 85})}), HasSubstr("yolov5 network of 80 classes"));
  auto incomplete = heads(kRow);
  incomplete.pop_back();
  EXPECT_FALSE(recognise_yolo(views(incomplete), kShape).ok());
  const auto wrong = check_outputs(YoloKind::yolov5, views(heads(kRow)), kShape);
  ASSERT_FALSE(wrong.ok());
  EXPECT_THAT(wrong.error().message, HasSubstr("'yolov5' needs [1, 378, 7]"));
  EXPECT_TRUE(check_outputs(YoloKind::yolox_heads, views(heads(kRow)), kShape).ok());
  EXPECT_THROW(decode_yolo(YoloKind::yolov5, views(heads(kRow)), kShape, 0.3F), std::logic_error);
}

TEST(YoloDecode, SuppressionInTheGraphGivesCorners) {
  Output output({1, 300, 6});
  const std::array<float, 12> rows = {4, 6, 20, 30, 0.9F, 1, 0, 0, 9, 9, 0.4F, 57};
  std::copy(rows.begin(), rows.end(), output.values.begin());
  EXPECT_EQ(recognise_yolo(views({output}), kShape).value(), YoloKind::end_to_end);
  const auto found = decode_yolo(YoloKind::end_to_end, views({output}), kShape, 0.3F);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].box_input, (Box{4, 6, 20, 30}));
  EXPECT_EQ(found[0].class_index, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.9F);
  EXPECT_EQ(found[1].class_index, 57) << "whoever reads it knows how many classes there are";
  const auto one_class = recognise_yolo(views({Output({1, 3 * kCells, 6})}), kShape);
  ASSERT_FALSE(one_class.ok());
  EXPECT_THAT(one_class.error().message, HasSubstr("yolov5 network of 1 classes"));
}

TEST(YoloDecode, ASegmentationNetworkIsSaidToBeOne) {
  const auto kind =
      recognise_yolo(views({Output({1, 38, kCells}), Output({1, 32, 24, 16})}), kShape);
  ASSERT_FALSE(kind.ok());
  EXPECT_THAT(kind.error().message, HasSubstr("is a segmentation network"));
}

TEST(YoloDecode, TheOrderOfChannelsInMemoryDoesNotMatter) {
  for (const auto& [kind, channels] :
       {std::pair{YoloKind::yolov5_heads, 3 * kRow}, std::pair{YoloKind::yolox_heads, kRow}}) {
    auto plain = heads(channels);
    unsigned state = 1;
    for (Output& output : plain) {
      for (float& v : output.values)
        v = static_cast<float>((state = state * 75 % 65537)) / 65537.0F;
    }
    auto turned = plain;
    std::vector<Tensor> views_of_turned;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      const std::size_t cells = plain[i].values.size() / static_cast<std::size_t>(channels);
      for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
        for (std::size_t cell = 0; cell < cells; ++cell) {
          turned[i].values[cell * static_cast<std::size_t>(channels) + c] =
              plain[i].values[c * cells + cell];
        }
      }
      views_of_turned.push_back({turned[i].shape, turned[i].values, true});
    }
    const auto expected = decode_yolo(kind, views(plain), kShape, 0.3F);
    const auto found = decode_yolo(kind, views_of_turned, kShape, 0.3F);
    ASSERT_GT(expected.size(), 5U);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].box_input, expected[i].box_input);
      EXPECT_EQ(found[i].class_index, expected[i].class_index);
      EXPECT_EQ(found[i].score, expected[i].score);
    }
  }
}

TEST(YoloDecode, KindsHaveNames) {
  for (const std::string& name : yolo_kind_names()) {
    const auto kind = parse_yolo_kind(name);
    ASSERT_TRUE(kind.has_value()) << name;
    EXPECT_EQ(to_string(*kind), name);
  }
  EXPECT_FALSE(parse_yolo_kind("auto").has_value());
}

}  // namespace
}  // namespace ydd
