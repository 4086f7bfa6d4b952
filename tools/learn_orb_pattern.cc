// SPDX-License-Identifier: Apache-2.0
// Learns the 256 brightness tests of the descriptor from images.
//
// The greedy procedure of Rublee et al., "ORB: an efficient alternative to SIFT or SURF",
// ICCV 2011, section 4.3: run every possible test on many patches around corners; order the tests
// by how near their mean is to 1/2; take them in that order, each only if its correlation with
// every test taken before stays below a threshold; raise the threshold until there are 256.
//
// Where we differ: patches are discs of 15 px radius turned to their canonical orientation (the
// paper: squares of 31 px), and the sums over 5x5 windows are pixels of the smoothed level, the
// same that the extractor reads. Windows of one test do not overlap, as in the paper.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "ydd/features/orb_blur.h"
#include "ydd/features/orb_extractor.h"
#include "ydd/features/orb_orientation.h"
#include "ydd/features/orb_pattern.h"
#include "ydd/features/orb_pyramid.h"
#include "ydd/features/simd.h"
#include "ydd/image/decode.h"

namespace {

using namespace ydd;

constexpr int kRadius = kOrbPatchRadius_px;
constexpr int kWindow_px = 5;
constexpr std::size_t kTests = 256;

struct Settings {
  std::vector<std::string> folders;
  int every = 10;
  int points = 1000;
  std::size_t patches = 40000;
  double max_imbalance = 0.2;
  unsigned seed = 1;
  std::string provenance;
  std::string out;
};

struct Position {
  int x = 0, y = 0;
};

std::vector<Position> disc_positions() {
  std::vector<Position> positions;
  for (int y = -kRadius; y <= kRadius; ++y) {
    for (int x = -kRadius; x <= kRadius; ++x) {
      if (x * x + y * y <= kRadius * kRadius) positions.push_back({x, y});
    }
  }
  return positions;
}

/// The brightness at every position of the disc, turned upright; one patch.
using Patch = std::vector<std::uint8_t>;

Patch turned_patch(const GreyView& smooth, int x, int y, double angle_rad,
                   const std::vector<Position>& positions) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  Patch patch;
  patch.reserve(positions.size());
  for (const Position& p : positions) {
    const auto u = static_cast<int>(std::lround(c * p.x - s * p.y));
    const auto v = static_cast<int>(std::lround(s * p.x + c * p.y));
    patch.push_back(smooth.row(y + v)[x + u]);
  }
  return patch;
}

void append_patches(const GreyImage& grey, int points, const std::vector<Position>& positions,
                    std::vector<Patch>& patches) {
  const OrbOptions options;
  OrbPyramid pyramid(options.levels, options.scale_step, 40);
  OrbBlur blur;
  const auto levels = pyramid.build(grey);
  const OrbFeatures features = OrbExtractor(options).extract(grey, points);
  for (int octave = 0; octave < static_cast<int>(levels.size()); ++octave) {
    const GreyView smooth = blur.apply(levels[octave]);
    const double factor = std::pow(options.scale_step, octave);
    const auto on_level = [factor](float at_px) {
      return static_cast<int>(std::lround((at_px + 0.5) / factor - 0.5));
    };
    for (const Keypoint& k : features.keypoints) {
      if (k.octave != octave) continue;
      patches.push_back(
          turned_patch(smooth, on_level(k.x_px), on_level(k.y_px), k.angle_rad, positions));
    }
  }
}

std::vector<std::filesystem::path> image_files(const Settings& settings) {
  std::vector<std::filesystem::path> chosen;
  for (const std::string& folder : settings.folders) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (std::size_t i = 0; i < files.size(); i += settings.every) chosen.push_back(files[i]);
  }
  return chosen;
}

/// Patch brightness by position: [position][patch], so that one test reads two rows.
std::vector<std::vector<std::uint8_t>> brightness_by_position(std::vector<Patch> patches,
                                                              const Settings& settings,
                                                              std::size_t positions) {
  std::mt19937_64 random(settings.seed);
  std::shuffle(patches.begin(), patches.end(), random);
  // Whole words of 64 patches: every bit of a test's outcome counts.
  const std::size_t count = std::min(settings.patches, patches.size()) / 64 * 64;
  std::vector<std::vector<std::uint8_t>> brightness(positions, std::vector<std::uint8_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t p = 0; p < positions; ++p) brightness[p][i] = patches[i][p];
  }
  return brightness;
}

/// The outcome of one test on all patches.
struct Outcome {
  std::vector<std::uint64_t> bits;
  double ones = 0.0;
};

Outcome outcome_of(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  Outcome outcome{std::vector<std::uint64_t>(a.size() / 64), 0.0};
  const auto darker = [&](std::size_t i) -> std::uint64_t {
    return ~simd::top_bits(simd::at_least(simd::load(&a[i]), simd::load(&b[i]))) & 0xffffffffU;
  };
  for (std::size_t w = 0; w < outcome.bits.size(); ++w) {
    outcome.bits[w] = darker(64 * w) | darker(64 * w + 32) << 32;
    outcome.ones += std::popcount(outcome.bits[w]);
  }
  return outcome;
}

struct Candidate {
  int a = 0, b = 0;  ///< positions
  double distance_from_half = 0.0;
};

std::vector<Candidate> ordered_candidates(const std::vector<Position>& positions,
                                          const std::vector<std::vector<std::uint8_t>>& brightness,
                                          double max_imbalance) {
  const auto patches = static_cast<double>(brightness[0].size());
  std::vector<Candidate> candidates;
  for (int a = 0; a < static_cast<int>(positions.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(positions.size()); ++b) {
      const bool overlap = std::abs(positions[a].x - positions[b].x) < kWindow_px &&
                           std::abs(positions[a].y - positions[b].y) < kWindow_px;
      if (overlap) continue;
      const double mean = outcome_of(brightness[a], brightness[b]).ones / patches;
      if (std::abs(mean - 0.5) > max_imbalance) continue;
      candidates.push_back({a, b, std::abs(mean - 0.5)});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& l, const auto& r) {
    return l.distance_from_half < r.distance_from_half;
  });
  return candidates;
}

// Pearson's coefficient of two binary variables.
double correlation(const Outcome& a, const Outcome& b) {
  const double n = 64.0 * static_cast<double>(a.bits.size());
  double both = 0.0;
  for (std::size_t w = 0; w < a.bits.size(); ++w) both += std::popcount(a.bits[w] & b.bits[w]);
  const double covariance = both / n - a.ones / n * b.ones / n;
  const auto variance = [n](double ones) { return ones / n * (1.0 - ones / n); };
  return covariance / std::sqrt(variance(a.ones) * variance(b.ones));
}

std::vector<Candidate> greedy_search(const std::vector<Candidate>& candidates,
                                     const std::vector<std::vector<std::uint8_t>>& brightness,
                                     double threshold) {
  std::vector<Candidate> taken;
  std::vector<Outcome> outcomes;
  for (const Candidate& c : candidates) {
    Outcome outcome = outcome_of(brightness[c.a], brightness[c.b]);
    const bool is_new = std::all_of(outcomes.begin(), outcomes.end(), [&](const Outcome& o) {
      return std::abs(correlation(o, outcome)) < threshold;
    });
    if (!is_new) continue;
    taken.push_back(c);
    outcomes.push_back(std::move(outcome));
    if (taken.size() == kTests) break;
  }
  return taken;
}

void write_pattern(const Settings& settings, const std::vector<Candidate>& tests,
                   const std::vector<Position>& positions, std::size_t patches, double threshold) {
  std::ofstream out(settings.out);
  out << "// SPDX-License-Identifier: Apache-2.0\n"
      << "// Written by tools/learn_orb_pattern.cc; do not edit.\n"
      << fmt::format("// Images: {}\n", settings.provenance)
      << fmt::format(
             "// Settings: --every {} --points {} --patches {} --max-imbalance {} --seed {};\n"
             "// {} patches, correlation of two tests below {:.2f}.\n",
             settings.every, settings.points, settings.patches, settings.max_imbalance,
             settings.seed, patches, threshold);
  for (const Candidate& c : tests) {
    const Position& a = positions[c.a];
    const Position& b = positions[c.b];
    out << fmt::format("{{{}, {}, {}, {}}},\n", a.x, a.y, b.x, b.y);
  }
}

int run(const Settings& settings) {
  const std::vector<Position> positions = disc_positions();
  std::vector<Patch> patches;
  for (const auto& file : image_files(settings)) {
    const auto colour = load_colour(file);
    if (!colour) {
      fmt::print(stderr, "{}\n", colour.error().message);
      return 1;
    }
    append_patches(to_grey(*colour), settings.points, positions, patches);
  }
  const auto brightness = brightness_by_position(std::move(patches), settings, positions.size());
  const std::vector<Candidate> candidates =
      ordered_candidates(positions, brightness, settings.max_imbalance);
  fmt::print("{} patches, {} tests\n", brightness[0].size(), candidates.size());
  constexpr double kThresholdStep = 0.01;
  for (double threshold = 0.3; threshold <= 1.0; threshold += kThresholdStep) {
    const std::vector<Candidate> tests = greedy_search(candidates, brightness, threshold);
    fmt::print("correlation below {:.2f}: {} tests\n", threshold, tests.size());
    if (tests.size() < kTests) continue;
    write_pattern(settings, tests, positions, brightness[0].size(), threshold);
    return 0;
  }
  fmt::print(stderr, "fewer than {} uncorrelated tests: give more images\n", kTests);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app("Learns the sampling pattern of the descriptor and writes it as a table");
  app.add_option("folders", settings.folders, "folders of images")->required();
  app.add_option("--every", settings.every, "take every n-th image of a folder");
  app.add_option("--points", settings.points, "corners of one image");
  app.add_option("--patches", settings.patches, "patches in all, drawn at random");
  app.add_option("--max-imbalance", settings.max_imbalance,
                 "greatest distance of a test's mean from 1/2");
  app.add_option("--seed", settings.seed, "of that drawing");
  app.add_option("--provenance", settings.provenance, "names and licences of the images");
  app.add_option("--out", settings.out, "file to write")->required();
  CLI11_PARSE(app, argc, argv);
  return run(settings);
}
