// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/coarse_depth.h"

#include <cstdlib>

#include <gtest/gtest.h>

namespace ydd {
namespace {

/// 6 x 5 cells of 8 px.
class CellPainting {
 public:
  static constexpr int kWidth = 48, kHeight = 40;
  explicit CellPainting(float z_m) : pixels_(std::size_t{kWidth} * kHeight, z_m) {}
  CellPainting& paint(int x0, int y0, int x1, int y1, float z_m) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x)
        pixels_[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)] = z_m;
    }
    return *this;
  }
  CoarseDepth coarse() const { return coarse_depth({kWidth, kHeight, pixels_}, 8); }

 private:
  std::vector<float> pixels_;
};

std::size_t cell_in(const CoarseDepth& depth, int column, int row) {
  return static_cast<std::size_t>(depth.grid.index(column, row));
}

/// Cells whose readings grow by `step_m` from column to column.
CoarseDepth slanted_cells(float first_m, float step_m) {
  CoarseDepth out = CellPainting(1.0F).coarse();
  for (int row = 0; row < out.grid.rows; ++row) {
    for (int column = 0; column < out.grid.columns; ++column) {
      out.z_m[cell_in(out, column, row)] = first_m + step_m * static_cast<float>(column);
    }
  }
  return out;
}

TEST(CellGrid, EveryCellBeginsWhereItsPixelsDo) {
  const CellGrid grid(640, 480, 8);
  for (int cell = 0; cell < grid.cells(); ++cell) {
    const Eigen::Vector2f at_px = grid.corner_px(static_cast<std::size_t>(cell));
    EXPECT_EQ(grid.index(grid.cell_of(at_px.x()), grid.cell_of(at_px.y())), cell);
    EXPECT_EQ(grid.index(grid.cell_of(at_px.x() + 7), grid.cell_of(at_px.y() + 7)), cell);
  }
}

TEST(CellGrid, LeavesOutCellsThatAreCutOff) {
  const CellGrid grid(23, 16, 8);
  EXPECT_EQ(grid.columns, 2);
  EXPECT_EQ(grid.rows, 2);
  EXPECT_TRUE(grid.contains(1, 1));
  EXPECT_FALSE(grid.contains(2, 1));
  EXPECT_FALSE(grid.contains(-1, 0));
  EXPECT_EQ(grid.cell_of(15.9F), 1);
}

TEST(CoarseDepth, ReadsTheMiddleAndTheReachOfTheSurroundings) {
  CellPainting painting(2.0F);  // cell (2, 2) in quarters
  painting.paint(16, 16, 20, 20, 1.0F).paint(20, 16, 24, 20, 4.0F).paint(16, 20, 20, 24, 3.0F);
  const CoarseDepth depth = painting.coarse();
  EXPECT_EQ(depth.z_m[cell_in(depth, 2, 2)], 2.0F);
  for (int row = 0; row < depth.grid.rows; ++row) {
    for (int column = 0; column < depth.grid.columns; ++column) {
      const bool beside = std::abs(column - 2) <= 1 && std::abs(row - 2) <= 1;
      EXPECT_EQ(depth.near_m[cell_in(depth, column, row)], beside ? 1.0F : 2.0F);
      EXPECT_EQ(depth.far_m[cell_in(depth, column, row)], beside ? 4.0F : 2.0F);
    }
  }
}

TEST(CoarseDepth, AHoleHasNoReadingButSurroundings) {
  CellPainting painting(2.0F);
  const CoarseDepth depth = painting.paint(16, 16, 24, 24, 0.0F).coarse();
  EXPECT_EQ(depth.z_m[cell_in(depth, 2, 2)], 0.0F);
  EXPECT_EQ(depth.near_m[cell_in(depth, 2, 2)], 2.0F);
  EXPECT_EQ(depth.far_m[cell_in(depth, 2, 2)], 2.0F);
}

TEST(CoarseDepth, SurroundingsThatAreMostlyHolesSayNothing) {
  CellPainting painting(2.0F);
  const CoarseDepth depth = painting.paint(0, 0, 24, 40, 0.0F).coarse();  // columns 0, 1, 2
  EXPECT_EQ(depth.near_m[cell_in(depth, 2, 2)], 0.0F);                    // 12 of 36
  EXPECT_EQ(depth.far_m[cell_in(depth, 2, 2)], 0.0F);
  EXPECT_EQ(depth.near_m[cell_in(depth, 3, 2)], 2.0F);  // 24 of 36
  EXPECT_EQ(depth.far_m[cell_in(depth, 3, 2)], 2.0F);
}

TEST(SurfaceDepth, InterpolatesASlantedPlane) {
  const CoarseDepth depth = slanted_cells(2.0F, 0.08F);  // 0.01 m each px
  for (const float x_px : {3.5F, 5.0F, 17.25F, 40.0F}) {
    EXPECT_NEAR(surface_depth(depth, x_px, 13.0F, 0.04F), 2.0F + 0.01F * (x_px - 3.5F), 1e-5);
  }
}

TEST(SurfaceDepth, KnowsNothingAcrossAnEdge) {
  CellPainting painting(3.0F);
  const CoarseDepth depth = painting.paint(0, 0, 24, 40, 2.0F).coarse();
  EXPECT_EQ(surface_depth(depth, 16.0F, 20.0F, 0.04F), 2.0F);
  EXPECT_EQ(surface_depth(depth, 24.0F, 20.0F, 0.04F), 0.0F);
  EXPECT_EQ(surface_depth(depth, 32.0F, 20.0F, 0.04F), 3.0F);
  EXPECT_GT(surface_depth(depth, 24.0F, 20.0F, 0.3F), 2.0F) << "no edge for larger steps";
}

TEST(SurfaceDepth, KnowsNothingInHolesAndOutside) {
  CellPainting painting(2.0F);
  const CoarseDepth depth = painting.paint(16, 16, 24, 24, 0.0F).coarse();
  EXPECT_EQ(surface_depth(depth, 18.0F, 18.0F, 0.04F), 0.0F);
  for (const float x_px : {-5.0F, 1.0F, 46.0F, 60.0F}) {
    EXPECT_EQ(surface_depth(depth, x_px, 10.0F, 0.04F), 0.0F) << x_px;
  }
}

TEST(CellRays, PointThroughTheCellsCentres) {
  Camera camera;
  camera.k1 = 0.1;
  const CellGrid grid(camera.width_px, camera.height_px, 8);
  const std::vector<Eigen::Vector2f> rays = cell_rays(camera, grid);
  ASSERT_EQ(rays.size(), static_cast<std::size_t>(grid.cells()));
  const Eigen::Vector2f& ray = rays[static_cast<std::size_t>(grid.index(10, 5))];
  const Eigen::Vector2d px = camera.distort(camera.project({ray.x(), ray.y(), 1.0}));
  EXPECT_NEAR(px.x(), 83.5, 1e-3);
  EXPECT_NEAR(px.y(), 43.5, 1e-3);
}

}  // namespace
}  // namespace ydd
