// SPDX-License-Identifier: Apache-2.0
// The inner loops for one instruction set against those for another one: equal to the last bit.
#include "ydd/features/orb_kernels.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr int kWidth = 131;  // no whole number of vectors
constexpr int kHeight = 40;
constexpr int kRowStride = 256;

template <class T>
std::vector<T> noise(std::size_t count, int low, int high, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<T> values(count);
  for (T& v : values) v = static_cast<T>(low + static_cast<int>(random() % (high - low + 1)));
  return values;
}

/// Everything that a set of kernels makes of one image.
struct Outcome {
  std::vector<std::uint8_t> bytes;
  std::vector<std::int16_t> shrunk;
  std::vector<std::array<int, 3>> corners;
  std::vector<std::array<int, 2>> moments;

  friend bool operator==(const Outcome&, const Outcome&) = default;
};

void add_corners(const OrbKernels& kernels, const std::vector<std::uint8_t>& image,
                 Outcome& outcome) {
  std::vector<std::vector<std::uint8_t>> scores(3, std::vector<std::uint8_t>(kRowStride));
  for (int y = 0; y < 3; ++y) {
    std::array<const std::uint8_t*, 7> rows;
    for (int i = 0; i < 7; ++i) rows[i] = &image[static_cast<std::size_t>((y + i) * kRowStride)];
    kernels.score_row(rows.data(), 4, kWidth - 4, 9, scores[y].data());
    outcome.bytes.insert(outcome.bytes.end(), scores[y].begin(), scores[y].begin() + kWidth - 4);
  }
  std::vector<Corner> corners(kRowStride);
  corners.resize(kernels.find_maxima(scores[0].data(), scores[1].data(), scores[2].data(), 5,
                                     kWidth - 5, 4, corners.data()));
  for (const Corner& c : corners) outcome.corners.push_back({c.x, c.y, c.score});
}

void add_blur(const OrbKernels& kernels, const std::vector<std::uint8_t>& image, Outcome& outcome) {
  std::vector<std::uint8_t> down(kRowStride);
  std::vector<std::uint8_t> along(kRowStride);
  kernels.blur_columns(&image[3 * kRowStride], kRowStride, kWidth, down.data());
  kernels.blur_along(down.data(), 3, kWidth - 3, along.data());
  outcome.bytes.insert(outcome.bytes.end(), down.begin(), down.end());
  outcome.bytes.insert(outcome.bytes.end(), along.begin(), along.end());
}

void add_pyramid(const OrbKernels& kernels, const std::vector<std::uint8_t>& image,
                 Outcome& outcome) {
  std::vector<ShrunkEight> columns(8);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c].first = static_cast<int>(9 * c);
    for (int k = 0; k < 8; ++k) {
      columns[c].index[2 * k] = static_cast<std::uint8_t>(k);
      columns[c].index[2 * k + 1] = static_cast<std::uint8_t>(k + 1);
      columns[c].weight[2 * k] = static_cast<std::uint8_t>(1 + (k * 17 + c * 5) % 127);
      columns[c].weight[2 * k + 1] = static_cast<std::uint8_t>(128 - columns[c].weight[2 * k]);
    }
  }
  std::vector<std::int16_t> rows[2];
  for (int i = 0; i < 2; ++i) {
    rows[i].resize(64);
    kernels.shrink_row(&image[static_cast<std::size_t>(i * kRowStride)], columns.data(),
                       columns.size(), rows[i].data());
    outcome.shrunk.insert(outcome.shrunk.end(), rows[i].begin(), rows[i].end());
  }
  std::vector<std::uint8_t> blended(64);
  kernels.blend_rows(rows[0].data(), rows[1].data(), 37, 64, blended.data());
  outcome.bytes.insert(outcome.bytes.end(), blended.begin(), blended.end());
}

Outcome outcome_of(const OrbKernels& kernels, unsigned seed, int low, int high) {
  const auto image = noise<std::uint8_t>(kHeight * kRowStride, low, high, seed);
  Outcome outcome;
  add_corners(kernels, image, outcome);
  add_blur(kernels, image, outcome);
  add_pyramid(kernels, image, outcome);
  for (int x = 0; x < 90; ++x) {
    const PatchMoments m = kernels.moments(&image[static_cast<std::size_t>(x)], kRowStride);
    outcome.moments.push_back({m.m10, m.m01});
  }
  return outcome;
}

TEST(OrbKernels, OfAllInstructionSetsGiveTheSame) {
  const auto all = runnable_orb_kernels();
  if (all.size() == 1) GTEST_SKIP() << "this processor runs only " << all[0]->instruction_set;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto [low, high] = seed % 2 == 0 ? std::pair(0, 255) : std::pair(100, 140);
    const Outcome first = outcome_of(*all[0], seed, low, high);
    EXPECT_FALSE(first.corners.empty());
    for (const OrbKernels* kernels : all.subspan(1)) {
      EXPECT_TRUE(first == outcome_of(*kernels, seed, low, high))
          << kernels->instruction_set << ", seed " << seed;
    }
  }
}

TEST(OrbKernels, ForAvx2AreTakenWhereTheProcessorHasIt) {
  EXPECT_EQ(&orb_kernels(), runnable_orb_kernels().back());
#if defined(__x86_64__)
  const bool has_it = __builtin_cpu_supports("avx2") != 0;
  EXPECT_EQ(std::string(orb_kernels().instruction_set) == "AVX2", has_it);
#endif
}

}  // namespace
}  // namespace ydd
