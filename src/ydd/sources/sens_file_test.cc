// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <bit>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/bags/bags_testing.h"
#include "ydd/base/files.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/sources/layouts_testing.h"
#include "ydd/sources/source.h"

namespace ydd::sources {
namespace {

using bags::little;
using testing::HasSubstr;

std::string matrix(std::initializer_list<float> values) {
  std::string out;
  for (const float value : values) out += little(std::bit_cast<std::uint32_t>(value), 4);
  return out;
}

/// Frames of 40 x 30 with colour of twice that and a stamp every 40 ms; the second has no pose.
class SensFile : public LayoutTest {
 protected:
  SensFile() {
    std::string text = little(4, 4) + bags::with_length("StructureSensor", 8);
    const std::string none = matrix({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    text += matrix({80, 0, 40, 0, 0, 80, 30, 0, 0, 0, 1, 0, 0, 0, 0, 1}) + none;
    text += matrix({41, 0, 19, 0, 0, 42, 14, 0, 0, 0, 1, 0, 0, 0, 0, 1}) + none;
    text += little(2, 4) + little(1, 4) + little(2 * kWidth, 4) + little(2 * kHeight, 4);
    text += little(kWidth, 4) + little(kHeight, 4);
    text += little(std::bit_cast<std::uint32_t>(1000.0F), 4) + little(3, 8);
    head_ = text.size();
    for (int i = 0; i < 3; ++i) {
      const float x = i == 1 ? -INFINITY : static_cast<float>(i);
      put_colour("c.jpg", 60 + i, 2 * kWidth, 2 * kHeight);
      const std::string colour = read_file(folder_ / "c.jpg").value();
      std::string depth;
      for (int k = 0; k < kWidth * kHeight; ++k)
        depth += little(2000U + static_cast<unsigned>(i), 2);
      std::string packed(compressBound(depth.size()), '\0');
      uLongf size = packed.size();
      compress(reinterpret_cast<Bytef*>(packed.data()), &size,
               reinterpret_cast<const Bytef*>(depth.data()), depth.size());
      packed.resize(size);
      text += matrix({1, 0, 0, x, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1});
      text += little(5'000'000U + 40'000U * static_cast<unsigned>(i), 8) + little(0, 8);
      text += little(colour.size(), 8) + little(packed.size(), 8) + colour + packed;
    }
    text_ = text;
    write("scene.sens", text_);
  }
  std::string text_;
  std::size_t head_ = 0;
};

TEST_F(SensFile, IsReadWithCameraStampsAndPoses) {
  const auto sequence = open_sequence(folder_ / "scene.sens");
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->recording().source, "sens");
  ASSERT_EQ(sequence->size(), 3U);
  EXPECT_EQ(sequence->entry(2).stamp.ns, 5'080'000'000);
  const Camera camera = find_camera(sequence->recording()).value();
  EXPECT_EQ(camera.fy_px, 42);
  const auto frame = sequence->read(2, camera);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->colour.width(), kWidth);
  EXPECT_NEAR(frame->colour(5, 5)[0], 62, 2);
  EXPECT_FLOAT_EQ(frame->depth_m(5, 5), 2.002F);
  const auto truth = sequence->groundtruth()->read();
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_EQ(truth->size(), 2U) << "an infinite pose is none";
  EXPECT_EQ(truth->at(1).T_world_camera.translation(), Eigen::Vector3d(2, 2, 3));
}

TEST_F(SensFile, CutOffAnywhereItIsReadUpToThere) {
  for (std::size_t size = 0; size < text_.size(); size += 1 + text_.size() / 97) {
    write("cut.sens", text_.substr(0, size));
    const auto sequence = open_sequence(folder_ / "cut.sens");
    if (!sequence) {
      EXPECT_THAT(sequence.error().message, HasSubstr("cut.sens: "));
      continue;
    }
    EXPECT_GT(size, head_);
    const Camera camera = find_camera(sequence->recording()).value();
    for (std::size_t i = 0; i < sequence->size(); ++i) EXPECT_TRUE(sequence->read(i, camera));
  }
}

TEST_F(SensFile, DamageIsOneLine) {
  for (std::size_t at = 0; at < text_.size(); at += 1 + text_.size() / 127) {
    std::string bad = text_;
    bad[at] = static_cast<char>(~bad[at]);
    write("bad.sens", bad);
    const auto sequence = open_sequence(folder_ / "bad.sens");
    if (!sequence) continue;
    for (std::size_t i = 0; i < sequence->size(); ++i) {
      const auto frame = sequence->read(i, Camera());
      EXPECT_TRUE(frame || frame.error().message.find('\n') == std::string::npos);
    }
  }
}

TEST_F(SensFile, WithoutStampsThirtyHertz) {
  std::string text = text_;
  std::size_t at = head_;
  for (int i = 0; i < 3; ++i) {
    text.replace(at + 64, 8, std::string(8, '\0'));
    const auto sizes = [&](std::size_t k) {
      std::uint64_t out = 0;
      for (std::size_t b = 0; b < 8; ++b) {
        out |= std::uint64_t{static_cast<unsigned char>(text[at + 80 + 8 * k + b])} << (8 * b);
      }
      return out;
    };
    at += 96 + sizes(0) + sizes(1);
  }
  write("scene.sens", text);
  EXPECT_EQ(open_sequence(folder_ / "scene.sens")->entry(1).stamp.ns, 33'333'333);
}

}  // namespace
}  // namespace ydd::sources
