// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_extractor.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "ydd/features/orb_blur.h"
#include "ydd/features/orb_brief.h"
#include "ydd/features/orb_corners.h"
#include "ydd/features/orb_distribution.h"
#include "ydd/features/orb_orientation.h"
#include "ydd/features/orb_pyramid.h"

namespace ydd {
namespace {

constexpr int kMinImage_px = 64;
// The descriptor reads the smoothed level up to the patch radius, which in turn reads three
// further.
constexpr int kBorder_px = kOrbPatchRadius_px + OrbBlur::kRadius_px;
constexpr int kMinLevel_px = 2 * kBorder_px + 4;

}  // namespace

void OrbOptions::describe(OptionTable& table) {
  table.add("levels", levels, {1, 16}, "", "pyramid levels");
  table.add("scale_step", scale_step, {1.05, 2.0}, "", "scale between neighbouring levels");
  table.add("fast_threshold", fast_threshold, {1, 254}, "grey levels",
            "contrast that a corner needs");
  table.add("fast_threshold_low", fast_threshold_low, {1, 254}, "grey levels",
            "contrast that a corner needs where a cell of 35 px has none otherwise");
  table.add("threads", threads, {1, 64}, "", "pyramid levels worked on at the same time");
}

/// What one level works with. Nothing is shared between levels, so they may run side by side.
struct LevelWork {
  CornerDetector detector;
  CornerSelector selector;
  OrbBlur blur;
  GreyView view;
  GreyView smooth;
  std::span<const Corner> corners;
  std::size_t first = 0;  ///< of its features in the result
};

struct OrbExtractor::Workspace {
  explicit Workspace(const OrbOptions& options)
      : pyramid(options.levels, options.scale_step, kMinLevel_px),
        scales(PyramidScales::make(options.levels, options.scale_step)),
        levels(static_cast<std::size_t>(options.levels)),
        arena(options.threads) {}

  OrbPyramid pyramid;
  PyramidScales scales;
  SteeredBrief brief;
  std::vector<LevelWork> levels;
  std::vector<int> available;
  oneapi::tbb::task_arena arena;
};

namespace {

template <class Body>
void each_level(oneapi::tbb::task_arena& arena, int threads, std::size_t count, const Body& body) {
  if (threads <= 1) {
    for (std::size_t l = 0; l < count; ++l) body(l);
    return;
  }
  arena.execute([&] {
    oneapi::tbb::parallel_for(std::size_t{0}, count, body, oneapi::tbb::simple_partitioner{});
  });
}

void detect(LevelWork& level, const OrbOptions& options) {
  level.corners = level.detector.detect(level.view, kBorder_px, options.fast_threshold,
                                        options.fast_threshold_low);
}

void describe(const LevelWork& level, const SteeredBrief& brief, int octave, double factor,
              OrbFeatures& result) {
  const auto to_level_0 = [factor](int at_px) {
    return static_cast<float>((at_px + 0.5) * factor - 0.5);
  };
  for (std::size_t i = 0; i < level.corners.size(); ++i) {
    const Corner& c = level.corners[i];
    const float angle_rad = intensity_centroid_angle_rad(level.view, c.x, c.y);
    result.keypoints[level.first + i] = {.x_px = to_level_0(c.x),
                                         .y_px = to_level_0(c.y),
                                         .angle_rad = angle_rad,
                                         .response = static_cast<float>(c.score),
                                         .octave = octave};
    result.descriptors[level.first + i] = brief.describe(level.smooth, c.x, c.y, angle_rad);
  }
}

}  // namespace

OrbExtractor::OrbExtractor(const OrbOptions& options)
    : options_(options), work_(std::make_unique<Workspace>(options)) {}
OrbExtractor::~OrbExtractor() = default;
OrbExtractor::OrbExtractor(OrbExtractor&&) noexcept = default;
OrbExtractor& OrbExtractor::operator=(OrbExtractor&&) noexcept = default;

OrbFeatures OrbExtractor::extract(const GreyImage& grey, int target) {
  OrbFeatures result;
  if (std::min(grey.width(), grey.height()) < kMinImage_px || target <= 0) return result;
  if (std::max(grey.width(), grey.height()) >= 32768) {
    throw std::logic_error("OrbExtractor: image larger than 32767 px");
  }
  Workspace& work = *work_;
  const std::span<const GreyView> views = work.pyramid.build(grey);
  const auto each = [&](const auto& body) {
    each_level(work.arena, options_.threads, views.size(), body);
  };
  each([&](std::size_t l) {
    work.levels[l].view = views[l];
    detect(work.levels[l], options_);
  });

  work.available.clear();
  for (std::size_t l = 0; l < views.size(); ++l) {
    work.available.push_back(static_cast<int>(work.levels[l].corners.size()));
  }
  const std::vector<int> quotas = level_quotas(target, options_.scale_step, work.available);
  std::size_t count = 0;
  for (std::size_t l = 0; l < views.size(); ++l) {
    work.levels[l].first = count;
    count += static_cast<std::size_t>(quotas[l]);
  }
  result.keypoints.resize(count);
  result.descriptors.resize(count);
  each([&](std::size_t l) {
    LevelWork& level = work.levels[l];
    level.corners =
        level.selector.select(level.corners, views[l].width, views[l].height, quotas[l]);
    if (level.corners.empty()) return;
    level.smooth = level.blur.apply(views[l]);
    describe(level, work.brief, static_cast<int>(l), work.scales.factor[l], result);
  });
  return result;
}

}  // namespace ydd
