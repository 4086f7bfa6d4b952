// SPDX-License-Identifier: Apache-2.0
// Each stage of the extractor against a plain restatement of its definition.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/features/orb_blur.h"
#include "ydd/features/orb_brief.h"
#include "ydd/features/orb_corners.h"
#include "ydd/features/orb_distribution.h"
#include "ydd/features/orb_orientation.h"
#include "ydd/features/orb_pyramid.h"

namespace ydd {
namespace {

using ::testing::ElementsAre;
using ::testing::Ge;
using ::testing::IsEmpty;
using ::testing::SizeIs;

GreyImage noise_image(int width, int height, unsigned seed, int low = 0, int high = 255) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width * height));
  for (auto& p : pixels) p = static_cast<std::uint8_t>(low + random() % (high - low + 1));
  return {width, height, std::move(pixels)};
}

GreyView view_of(const GreyImage& image) {
  return {image.data(), image.width(), image.height(), image.width()};
}

int plain_fast_score(const GreyImage& im, int x, int y) {
  constexpr int kDx[16] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr int kDy[16] = {-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};
  int best = 0;
  for (int start = 0; start < 16; ++start) {
    int bright = 255;
    int dark = 255;
    for (int k = start; k < start + 9; ++k) {
      const int difference = im(x + kDx[k % 16], y + kDy[k % 16]) - im(x, y);
      bright = std::min(bright, difference);
      dark = std::min(dark, -difference);
    }
    best = std::max({best, bright, dark});
  }
  return best;
}

std::vector<std::array<int, 3>> plain_corners(const GreyImage& im, int border, int threshold) {
  const auto score = [&](int x, int y) {
    const int s = plain_fast_score(im, x, y);
    return s > threshold ? s : 0;
  };
  std::vector<std::array<int, 3>> corners;
  for (int y = border; y < im.height() - border; ++y) {
    for (int x = border; x < im.width() - border; ++x) {
      const int s = score(x, y);
      bool is_maximum = s > 0;
      for (int dy = -1; dy <= 1 && is_maximum; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const bool before = dy < 0 || (dy == 0 && dx < 0);
          const int other = dy == 0 && dx == 0 ? 0 : score(x + dx, y + dy);
          if (before ? other >= s : other > s) is_maximum = false;
        }
      }
      if (is_maximum) corners.push_back({x, y, s});
    }
  }
  return corners;
}

TEST(CornerDetector, FindsWhatTheDefinitionOfFastFinds) {
  for (const int width : {64, 97, 150}) {
    const GreyImage image = noise_image(width, 70, static_cast<unsigned>(width), 90, 150);
    CornerDetector detector;
    std::vector<std::array<int, 3>> found;
    for (const Corner& c : detector.detect(view_of(image), 5, 7, 7)) {
      found.push_back({c.x, c.y, c.score});
    }
    EXPECT_THAT(found, SizeIs(Ge(20U)));
    EXPECT_EQ(found, plain_corners(image, 5, 7)) << "width " << width;
  }
}

TEST(CornerDetector, AsksForLessContrastOnlyWhereACellHasNoStrongCorner) {
  // Two cells side by side: bright and faint squares in the left one, faint ones in the right one.
  std::vector<std::uint8_t> pixels(80 * 45, 100);
  const auto square = [&](int x0, int y0, int brightness) {
    for (int y = y0; y < y0 + 4; ++y) {
      for (int x = x0; x < x0 + 4; ++x) pixels[y * 80 + x] = static_cast<std::uint8_t>(brightness);
    }
  };
  square(10, 10, 200);
  square(25, 25, 112);
  square(55, 20, 112);
  const GreyImage image(80, 45, pixels);
  CornerDetector detector;
  const std::span<const Corner> corners = detector.detect(view_of(image), 5, 20, 7);
  ASSERT_FALSE(corners.empty());
  bool faint_on_the_right = false;
  for (const Corner& c : corners) {
    EXPECT_TRUE(c.x >= 40 || c.score > 20);
    faint_on_the_right = faint_on_the_right || (c.x > 50 && c.score <= 12);
  }
  EXPECT_TRUE(faint_on_the_right);
}

TEST(CornerDetector, FindsNoneInAFlatOrTinyImage) {
  CornerDetector detector;
  const GreyImage flat(100, 100, std::vector<std::uint8_t>(10000, 77));
  EXPECT_THAT(detector.detect(view_of(flat), 18, 20, 7), IsEmpty());
  const GreyImage tiny = noise_image(30, 30, 1);
  EXPECT_THAT(detector.detect(view_of(tiny), 18, 20, 7), IsEmpty());
}

TEST(OrbPyramid, InterpolatesBetweenPixelCentres) {
  // A plane of brightness stays one: each level can be told from its coordinates.
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 161; ++x) pixels.push_back(static_cast<std::uint8_t>(20 + x + y / 2));
  }
  const GreyImage image(161, 120, pixels);
  OrbPyramid pyramid(6, 1.2, 40);
  const std::span<const GreyView> levels = pyramid.build(image);
  ASSERT_THAT(levels, SizeIs(6));
  EXPECT_EQ(levels[0].pixels, image.data());
  for (std::size_t l = 1; l < levels.size(); ++l) {
    EXPECT_EQ(levels[l].width, static_cast<int>(levels[l - 1].width / 1.2));
    const double factor = std::pow(1.2, static_cast<double>(l));
    for (int y = 0; y < levels[l].height; ++y) {
      for (int x = 0; x < levels[l].width; ++x) {
        const double x0 = (x + 0.5) * factor - 0.5;
        const double y0 = (y + 0.5) * factor - 0.5;
        ASSERT_NEAR(levels[l].row(y)[x], 20 + x0 + y0 / 2 - 0.25, 2.0) << l << " " << x << " " << y;
      }
    }
  }
}

TEST(OrbPyramid, LeavesOutLevelsThatAreTooSmall) {
  OrbPyramid pyramid(8, 2.0, 40);
  EXPECT_THAT(pyramid.build(noise_image(170, 200, 3)), SizeIs(3));
  EXPECT_THAT(pyramid.build(noise_image(39, 200, 3)), IsEmpty());
  EXPECT_THAT(pyramid.build(noise_image(640, 480, 3)), SizeIs(4));
}

TEST(OrbBlur, IsTheKernelItClaims) {
  const GreyImage image = noise_image(75, 60, 5);
  OrbBlur blur;
  const GreyView smooth = blur.apply(view_of(image));
  constexpr int kKernel[7] = {1, 2, 3, 4, 3, 2, 1};
  double bias = 0.0;
  for (int y = 3; y < 57; ++y) {
    for (int x = 3; x < 72; ++x) {
      double sum = 0.0;
      for (int dy = -3; dy <= 3; ++dy) {
        for (int dx = -3; dx <= 3; ++dx) {
          sum += kKernel[dx + 3] * kKernel[dy + 3] * image(x + dx, y + dy) / 256.0;
        }
      }
      ASSERT_NEAR(smooth.row(y)[x], sum + 1.0, 2.5) << x << " " << y;
      bias += (smooth.row(y)[x] - sum) / (54 * 69);
    }
  }
  EXPECT_NEAR(bias, 2.0, 0.5);
}

TEST(Orientation, IsTheAngleOfTheIntensityCentroid) {
  const GreyImage image = noise_image(40, 40, 11);
  for (const int x : {16, 20, 23}) {
    double m10 = 0.0;
    double m01 = 0.0;
    for (int v = -15; v <= 15; ++v) {
      for (int u = -15; u <= 15; ++u) {
        if (u * u + v * v > 240) continue;
        m10 += u * image(x + u, 19 + v);
        m01 += v * image(x + u, 19 + v);
      }
    }
    const double angle = std::atan2(m01, m10);
    const double positive = angle < 0 ? angle + 2 * std::numbers::pi : angle;
    EXPECT_NEAR(intensity_centroid_angle_rad(view_of(image), x, 19), positive, 1e-5);
  }
}

TEST(Orientation, SurvivesTheLargestContrast) {
  for (const bool swap : {false, true}) {
    std::vector<std::uint8_t> pixels(40 * 40);
    for (int i = 0; i < 1600; ++i) pixels[i] = (i / 40 > 19) != swap ? 255 : 0;
    const GreyImage image(40, 40, pixels);
    const double expected = swap ? 1.5 * std::numbers::pi : 0.5 * std::numbers::pi;
    EXPECT_NEAR(intensity_centroid_angle_rad(view_of(image), 19, 19), expected, 1e-5);
  }
}

TEST(Orientation, FastAtan2IsAtan2) {
  EXPECT_EQ(fast_atan2_rad(0, 0), 0.0F);
  for (int i = 0; i < 2000; ++i) {
    const double angle = i * std::numbers::pi / 1000;
    const auto y = static_cast<float>(3000 * std::sin(angle));
    const auto x = static_cast<float>(3000 * std::cos(angle));
    const float got = fast_atan2_rad(y, x);
    EXPECT_NEAR(std::remainder(got - angle, 2 * std::numbers::pi), 0.0, 1e-6) << i;
    EXPECT_GE(got, 0.0F);
    EXPECT_LT(got, 2 * std::numbers::pi);
  }
}

TEST(SteeredBrief, ComparesTheTurnedPairs) {
  const GreyImage image = noise_image(64, 64, 17);
  const SteeredBrief brief;
  for (const int step : {0, 1, SteeredBrief::kAngles / 4, SteeredBrief::kAngles - 1}) {
    const double angle = step * 2 * std::numbers::pi / SteeredBrief::kAngles;
    const Descriptor d = brief.describe(view_of(image), 30, 31, static_cast<float>(angle));
    for (std::size_t i = 0; i < kOrbPattern.size(); ++i) {
      const auto at = [&](int x, int y) {
        const double u = std::cos(angle) * x - std::sin(angle) * y;
        const double v = std::sin(angle) * x + std::cos(angle) * y;
        return image(30 + static_cast<int>(std::lround(u)), 31 + static_cast<int>(std::lround(v)));
      };
      const OrbTest& t = kOrbPattern[i];
      ASSERT_EQ((d[i / 64] >> (i % 64)) & 1, at(t.ax, t.ay) < at(t.bx, t.by) ? 1U : 0U) << i;
    }
  }
}

TEST(OrbPattern, StaysInThePatchAndHoldsNoTestTwice) {
  std::set<std::array<int, 4>> seen;
  for (const OrbTest& t : kOrbPattern) {
    EXPECT_LE(t.ax * t.ax + t.ay * t.ay, 15 * 15);
    EXPECT_LE(t.bx * t.bx + t.by * t.by, 15 * 15);
    const std::array<int, 4> test = {t.ax, t.ay, t.bx, t.by};
    const std::array<int, 4> opposite = {t.bx, t.by, t.ax, t.ay};
    EXPECT_TRUE(seen.insert(test).second);
    EXPECT_FALSE(seen.contains(opposite));
  }
}

TEST(LevelQuotas, FollowTheGeometricSplit) {
  const std::vector<int> plenty(8, 100000);
  const std::vector<int> quotas = level_quotas(1000, 1.2, plenty);
  const double b = 1 / 1.2;
  int sum = 0;
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(quotas[i], 1000 * (1 - b) / (1 - std::pow(b, 8)) * std::pow(b, i), 1.0);
    sum += quotas[i];
  }
  EXPECT_EQ(sum, 1000);
}

TEST(LevelQuotas, HandOnWhatALevelCannotUse) {
  EXPECT_THAT(level_quotas(100, 2.0, std::vector<int>{10, 1000, 1000}), ElementsAre(10, 60, 30));
  EXPECT_THAT(level_quotas(100, 2.0, std::vector<int>{10, 20, 30}), ElementsAre(10, 20, 30));
  EXPECT_THAT(level_quotas(0, 2.0, std::vector<int>{10, 20}), ElementsAre(0, 0));
  EXPECT_THAT(level_quotas(100, 2.0, {}), IsEmpty());
}

TEST(CornerSelector, GivesExactlyTheCountAndSpreadsIt) {
  // Nine tenths of the corners crowd in one corner of the image, and are the stronger ones.
  std::mt19937 random(3);
  std::vector<Corner> corners;
  for (int i = 0; i < 5000; ++i) {
    const bool crowd = i % 10 != 0;
    corners.push_back({static_cast<std::uint16_t>(random() % (crowd ? 160 : 640)),
                       static_cast<std::uint16_t>(random() % (crowd ? 120 : 480)),
                       static_cast<std::uint16_t>(crowd ? 200 + random() % 50 : 30)});
  }
  CornerSelector selector;
  for (const int count : {1, 10, 100, 400, 1000, 4000}) {
    const std::span<const Corner> chosen = selector.select(corners, 640, 480, count);
    ASSERT_THAT(chosen, SizeIs(count));
    if (count != 400) continue;
    std::set<int> cells;
    for (const Corner& c : chosen) cells.insert(c.y / 80 * 8 + c.x / 80);
    EXPECT_GE(cells.size(), 46U) << "of 48 cells of 80 px";
  }
  EXPECT_THAT(selector.select(corners, 640, 480, 6000), SizeIs(5000));
  EXPECT_THAT(selector.select(corners, 640, 480, 0), IsEmpty());
}

TEST(CornerSelector, PrefersTheStrongerOfTwoNeighbours) {
  const std::vector<Corner> corners = {{100, 100, 20}, {102, 100, 90}, {400, 300, 15}};
  CornerSelector selector;
  const std::span<const Corner> chosen = selector.select(corners, 640, 480, 2);
  ASSERT_THAT(chosen, SizeIs(2));
  EXPECT_EQ(chosen[0].score, 90);
  EXPECT_EQ(chosen[1].score, 15);
}

}  // namespace
}  // namespace ydd
