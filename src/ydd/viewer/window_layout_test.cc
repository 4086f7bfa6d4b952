// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/window_layout.h"

#include <array>
#include <utility>

#include <gtest/gtest.h>

namespace ydd {
namespace {

bool overlap(const PixelRect& a, const PixelRect& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

TEST(WindowLayout, PartsNeitherOverlapNorLeaveTheWindow) {
  for (const auto& [width, height] :
       {std::pair{640, 480}, {1280, 720}, {1920, 1080}, {800, 1200}}) {
    for (const double aspect : {4.0 / 3, 16.0 / 9, 0.75}) {
      const WindowLayout layout = layout_window(width, height, aspect);
      const std::array parts = {layout.toolbar, layout.picture, layout.charts, layout.map};
      for (std::size_t i = 0; i < parts.size(); ++i) {
        EXPECT_GE(parts[i].x, 0);
        EXPECT_GE(parts[i].y, 0);
        EXPECT_LE(parts[i].right(), width);
        EXPECT_LE(parts[i].bottom(), height);
        EXPECT_GT(parts[i].width, 30);
        EXPECT_GT(parts[i].height, 30);
        for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(overlap(parts[i], parts[k])) << i << k;
      }
      EXPECT_NEAR(1.0 * layout.picture.width / layout.picture.height, aspect, 0.02);
    }
  }
}

TEST(WindowLayout, AtItsOwnSizePictureAndMapAreLarge) {
  const WindowLayout layout = layout_window(1280, 720, 4.0 / 3);
  EXPECT_GT(layout.picture.width, 520);
  EXPECT_GT(layout.map.width, 680);
  EXPECT_GT(layout.charts.height, 200);
}

}  // namespace
}  // namespace ydd
