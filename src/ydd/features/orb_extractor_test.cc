// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_extractor.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/features/orb_brief.h"

namespace ydd {
namespace {

using ::testing::SizeIs;

/// Discs and boxes of all sizes and greys, each lying on the ones before ("dead leaves"), that can
/// be sampled between pixels, 500 px around the image too.
class Texture {
 public:
  explicit Texture(unsigned seed) : pixels_(kSize * kSize, 128) {
    std::mt19937 random(seed);
    for (int i = 0; i < 60000; ++i) {
      // Sizes fall with the inverse cube, as in pictures of the real world.
      const double r =
          std::min(2.5 / std::sqrt(static_cast<double>(random() % 10000 + 1) / 10000), 90.0);
      // One by one: the order in which arguments are evaluated is not the same everywhere.
      const bool is_disc = random() % 2 == 0;
      const auto grey = static_cast<std::uint8_t>(random() % 256);
      const auto cy = static_cast<int>(random() % kSize);
      const auto cx = static_cast<int>(random() % kSize);
      put(cx, cy, r, grey, is_disc);
    }
  }
  double at(double x, double y) const {
    x += kMargin;
    y += kMargin;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const double u = x - i, v = y - j;
    return (1 - v) * ((1 - u) * pixel(i, j) + u * pixel(i + 1, j)) +
           v * ((1 - u) * pixel(i, j + 1) + u * pixel(i + 1, j + 1));
  }

 private:
  static constexpr int kSize = 1800;
  static constexpr int kMargin = 500;
  double pixel(int x, int y) const {
    return pixels_.at(static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x));
  }
  void put(int cx, int cy, double r, std::uint8_t grey, bool is_disc) {
    const int reach = static_cast<int>(r);
    for (int y = std::max(cy - reach, 0); y <= std::min(cy + reach, kSize - 1); ++y) {
      for (int x = std::max(cx - reach, 0); x <= std::min(cx + reach, kSize - 1); ++x) {
        if (is_disc && std::hypot(x - cx, y - cy) > r) continue;
        pixels_[static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x)] = grey;
      }
    }
  }
  std::vector<std::uint8_t> pixels_;
};

using Warp = std::function<std::pair<double, double>(double, double)>;

GreyImage render(const Texture& texture, int width, int height, const Warp& to_texture) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto [u, v] = to_texture(x, y);
      pixels.push_back(static_cast<std::uint8_t>(std::lround(texture.at(u, v))));
    }
  }
  return {width, height, std::move(pixels)};
}

GreyImage upright(const Texture& texture, int width = 640, int height = 480) {
  return render(texture, width, height, [](double x, double y) { return std::pair{x, y}; });
}

/// Turned by `angle_rad` about the centre of 640x480 and magnified.
Warp similarity(double angle_rad, double magnification) {
  const double c = std::cos(angle_rad) / magnification, s = std::sin(angle_rad) / magnification;
  return [c, s](double x, double y) {
    const double u = x - 320, v = y - 240;
    return std::pair{c * u - s * v + 320, s * u + c * v + 240};
  };
}

struct MatchCount {
  int right = 0;
  int wrong = 0;
};

/// Matches `seen` to `reference` by mutual nearest descriptors; right within 3 px of the truth,
/// scaled with the keypoint's level.
MatchCount match(const OrbFeatures& seen, const OrbFeatures& reference, const Warp& to_reference) {
  const auto nearest = [](const Descriptor& d, const OrbFeatures& in) {
    std::pair<int, int> best{257, -1};
    for (std::size_t i = 0; i < in.descriptors.size(); ++i) {
      best = std::min(best, {hamming_distance(d, in.descriptors[i]), static_cast<int>(i)});
    }
    return best;
  };
  MatchCount count;
  for (std::size_t i = 0; i < seen.descriptors.size(); ++i) {
    const auto [distance, j] = nearest(seen.descriptors[i], reference);
    if (distance > 50) continue;
    if (nearest(reference.descriptors[j], seen).second != static_cast<int>(i)) continue;
    const auto [x, y] = to_reference(seen.keypoints[i].x_px, seen.keypoints[i].y_px);
    const Keypoint& k = reference.keypoints[j];
    const bool right = std::hypot(k.x_px - x, k.y_px - y) < 3 * std::pow(1.2, k.octave);
    ++(right ? count.right : count.wrong);
  }
  return count;
}

TEST(OrbExtractor, GivesTheNumberAskedForSpreadOverImageAndLevels) {
  const GreyImage image = upright(Texture(1));
  OrbExtractor extractor(OrbOptions{});
  for (const int target : {300, 1000, 2000, 3500}) {
    const OrbFeatures f = extractor.extract(image, target);
    EXPECT_NEAR(static_cast<double>(f.keypoints.size()), target, 0.02 * target);
    ASSERT_EQ(f.keypoints.size(), f.descriptors.size());
    std::array<int, 8> of_level{};
    std::array<int, 48> of_cell{};
    for (const Keypoint& k : f.keypoints) {
      ASSERT_TRUE(k.octave >= 0 && k.octave < 8);
      ++of_level[k.octave];
      ++of_cell[static_cast<int>(k.y_px / 80) * 8 + static_cast<int>(k.x_px / 80)];
      EXPECT_TRUE(k.angle_rad >= 0 && k.angle_rad < 2 * std::numbers::pi);
      EXPECT_GT(k.response, 7.0F);
    }
    const double b = 1 / 1.2;
    for (int l = 0; l < 8; ++l) {
      const double share = (1 - b) / (1 - std::pow(b, 8)) * std::pow(b, l);
      EXPECT_NEAR(of_level[l], share * target, 0.05 * target) << "level " << l;
    }
    for (const int count : of_cell) EXPECT_GE(count, target / 48 / 4);
  }
}

TEST(OrbExtractor, MatchesSurviveRotation) {
  const Texture texture(2);
  OrbExtractor extractor(OrbOptions{});
  const OrbFeatures reference = extractor.extract(upright(texture), 1000);
  for (const int degrees : {10, 30, 45, 90, 180}) {
    const Warp warp = similarity(degrees * std::numbers::pi / 180, 1.0);
    const OrbFeatures seen = extractor.extract(render(texture, 640, 480, warp), 1000);
    const MatchCount count = match(seen, reference, warp);
    EXPECT_GE(count.right, 250) << degrees << " degrees";
    EXPECT_LE(count.wrong * 4, count.right) << degrees << " degrees";
  }
}

TEST(OrbExtractor, MatchesSurviveScale) {
  const Texture texture(3);
  OrbExtractor extractor(OrbOptions{});
  const OrbFeatures reference = extractor.extract(upright(texture), 1000);
  const Warp warp = similarity(0.0, 1.44);
  const OrbFeatures seen = extractor.extract(render(texture, 640, 480, warp), 1000);
  const MatchCount count = match(seen, reference, warp);
  EXPECT_GE(count.right, 150);
  EXPECT_LE(count.wrong * 2, count.right);
}

TEST(OrbExtractor, CoordinatesCarryNoBiasFromTheLevel) {
  // Seen twice as large, a corner lies at 2 x + 0.5 (centres at integers), whatever its level.
  const Texture texture(4);
  OrbExtractor extractor(OrbOptions{});
  const OrbFeatures reference = extractor.extract(upright(texture), 1500);
  const Warp warp = similarity(0.0, 1.728);
  const OrbFeatures seen = extractor.extract(render(texture, 640, 480, warp), 1500);
  double dx = 0, dy = 0;
  int count = 0;
  for (std::size_t i = 0; i < seen.keypoints.size(); ++i) {
    for (std::size_t j = 0; j < reference.keypoints.size(); ++j) {
      if (hamming_distance(seen.descriptors[i], reference.descriptors[j]) > 40) continue;
      const auto [x, y] = warp(seen.keypoints[i].x_px, seen.keypoints[i].y_px);
      const double ex = reference.keypoints[j].x_px - x, ey = reference.keypoints[j].y_px - y;
      if (std::hypot(ex, ey) > 5) continue;
      dx += ex;
      dy += ey;
      ++count;
    }
  }
  ASSERT_GE(count, 100);
  EXPECT_NEAR(dx / count, 0.0, 0.25);
  EXPECT_NEAR(dy / count, 0.0, 0.25);
}

void expect_byte_equal(const OrbFeatures& a, const OrbFeatures& b) {
  ASSERT_EQ(a.keypoints.size(), b.keypoints.size());
  EXPECT_EQ(a.descriptors, b.descriptors);
  EXPECT_EQ(
      std::memcmp(a.keypoints.data(), b.keypoints.data(), a.keypoints.size() * sizeof(Keypoint)),
      0);
}

TEST(OrbExtractor, IsDeterministicWhateverTheThreadsAndWhatCameBefore) {
  const GreyImage image = upright(Texture(5));
  OrbExtractor single(OrbOptions{});
  OrbExtractor parallel(OrbOptions{.threads = 2});
  const OrbFeatures first = single.extract(image, 1000);
  single.extract(upright(Texture(6), 320, 240), 3500);
  single.extract(upright(Texture(7)), 2000);
  expect_byte_equal(first, single.extract(image, 1000));
  for (int i = 0; i < 5; ++i) expect_byte_equal(first, parallel.extract(image, 1000));
}

TEST(OrbExtractor, TinyAndFlatImagesGiveNone) {
  OrbExtractor extractor(OrbOptions{});
  EXPECT_THAT(extractor.extract(GreyImage(), 1000).keypoints, SizeIs(0));
  EXPECT_THAT(extractor.extract(upright(Texture(1), 63, 480), 1000).keypoints, SizeIs(0));
  EXPECT_THAT(extractor.extract(upright(Texture(1), 480, 63), 1000).keypoints, SizeIs(0));
  const GreyImage flat(640, 480, std::vector<std::uint8_t>(640 * 480, 128));
  EXPECT_THAT(extractor.extract(flat, 1000).keypoints, SizeIs(0));
  EXPECT_THAT(extractor.extract(upright(Texture(1)), 0).keypoints, SizeIs(0));
}

TEST(OrbExtractor, TakesAnySizeFrom64On) {
  OrbExtractor extractor(OrbOptions{});
  for (const auto& [width, height] : {std::pair{64, 64}, {65, 131}, {641, 97}, {1283, 721}}) {
    const OrbFeatures f = extractor.extract(upright(Texture(8), width, height), 500);
    EXPECT_GT(f.keypoints.size(), 10U) << width << "x" << height;
    for (const Keypoint& k : f.keypoints) {
      EXPECT_TRUE(k.x_px >= 18 && std::lround(k.x_px) <= width - 19);
      EXPECT_TRUE(k.y_px >= 18 && std::lround(k.y_px) <= height - 19);
    }
  }
}

TEST(OrbExtractor, FewerLevelsAndAnotherStepWork) {
  OrbExtractor extractor(OrbOptions{.levels = 3, .scale_step = 2.0});
  const OrbFeatures f = extractor.extract(upright(Texture(9)), 700);
  EXPECT_EQ(f.keypoints.size(), 700U);
  std::array<int, 3> of_level{};
  for (const Keypoint& k : f.keypoints) ++of_level.at(k.octave);
  EXPECT_EQ(of_level, (std::array<int, 3>{400, 200, 100}));
}

}  // namespace
}  // namespace ydd
