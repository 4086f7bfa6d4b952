// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/window_layout.h"

#include <algorithm>
#include <cmath>

namespace ydd {
namespace {

constexpr int kToolbar_px = 46;
constexpr int kGap_px = 6;
constexpr int kLeastCharts_px = 150;
constexpr double kPictureShare = 0.44;  // of the width

}  // namespace

WindowLayout layout_window(int width_px, int height_px, double picture_aspect) {
  WindowLayout layout;
  layout.toolbar = {0, 0, width_px, std::min(kToolbar_px, height_px)};
  const int top = layout.toolbar.bottom();
  const int left_width = static_cast<int>(std::lround(kPictureShare * width_px)) - kGap_px;
  const int tallest = std::max(1, height_px - top - kLeastCharts_px - 2 * kGap_px);
  const int by_width = static_cast<int>(std::lround(left_width / picture_aspect));
  // A low window, or a tall picture: as high as the charts allow, in the middle of its column.
  const int height = std::min(by_width, tallest);
  const int width = std::min(left_width, static_cast<int>(std::lround(height * picture_aspect)));
  layout.picture = {kGap_px + (left_width - width) / 2, top, width, height};
  const int charts_top = layout.picture.bottom() + kGap_px;
  layout.charts = {kGap_px, charts_top, left_width, std::max(1, height_px - charts_top - kGap_px)};
  const int map_left = layout.charts.right() + kGap_px;
  layout.map = {map_left, top, std::max(1, width_px - map_left - kGap_px),
                std::max(1, height_px - top - kGap_px)};
  return layout;
}

}  // namespace ydd
