// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/surfaces.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

/// 12 x 10 cells; at 2 m a cell is 0.1 m wide.
struct CellScene {
  CoarseDepth depth;
  std::vector<Eigen::Vector2f> rays;

  explicit CellScene(float z_m) {
    Camera camera;
    camera.fx_px = camera.fy_px = 160;
    depth.grid = CellGrid(96, 80, 8);
    depth.z_m.assign(static_cast<std::size_t>(depth.grid.cells()), z_m);
    rays = cell_rays(camera, depth.grid);
  }
  float& at(int column, int row) {
    return depth.z_m[static_cast<std::size_t>(depth.grid.index(column, row))];
  }
  Surfaces find(double radius_m) const {
    EvidenceOptions options;
    options.patch_radius_m = radius_m;
    return find_surfaces(depth, rays, options);
  }
  Eigen::Vector3f point(std::size_t cell) const {
    return {rays[cell].x() * depth.z_m[cell], rays[cell].y() * depth.z_m[cell], depth.z_m[cell]};
  }
};

TEST(FindSurfaces, AWallWithinReachIsOnePiece) {
  const Surfaces found = CellScene(2.0F).find(10);
  EXPECT_EQ(found.count, 1);
  for (const int piece : found.piece) EXPECT_EQ(piece, 0);
}

TEST(FindSurfaces, PiecesDoNotCrossADepthStep) {
  CellScene scene(2.0F);
  for (int row = 0; row < 10; ++row) {
    for (int column = 6; column < 12; ++column) scene.at(column, row) = 2.1F;  // 5 %
  }
  const Surfaces found = scene.find(10);
  EXPECT_EQ(found.count, 2);
  for (std::size_t i = 0; i < found.piece.size(); ++i) {
    EXPECT_EQ(found.piece[i], scene.depth.z_m[i] > 2.05F ? 1 : 0);
  }
}

TEST(FindSurfaces, ASlantIsNoStep) {
  CellScene scene(2.0F);
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 12; ++column) {
      scene.at(column, row) = 2.0F + 0.06F * static_cast<float>(column);  // 3 % and less
    }
  }
  EXPECT_EQ(scene.find(10).count, 1);
}

TEST(FindSurfaces, PiecesAreLimitedInSize) {
  const CellScene scene(2.0F);
  const Surfaces found = scene.find(0.25);
  EXPECT_GT(found.count, 4);
  EXPECT_LT(found.count, 40);
  std::vector<int> first(static_cast<std::size_t>(found.count), -1);
  for (std::size_t i = 0; i < found.piece.size(); ++i) {
    ASSERT_GE(found.piece[i], 0);
    ASSERT_LT(found.piece[i], found.count);
    int& centre = first[static_cast<std::size_t>(found.piece[i])];
    if (centre < 0) centre = static_cast<int>(i);
    const Eigen::Vector3f off = scene.point(i) - scene.point(static_cast<std::size_t>(centre));
    EXPECT_LE(off.norm(), 0.25F + 1e-5F);
  }
  EXPECT_EQ(found.piece[0], found.piece[2]) << "0.2 m";
  EXPECT_NE(found.piece[0], found.piece[3]) << "0.3 m";
}

TEST(FindSurfaces, CellsWithoutAReadingBelongToNone) {
  CellScene scene(2.0F);
  for (int row = 0; row < 10; ++row) scene.at(5, row) = 0;
  const Surfaces found = scene.find(10);
  EXPECT_EQ(found.count, 2) << "and they part a wall";
  for (std::size_t i = 0; i < found.piece.size(); ++i) {
    EXPECT_EQ(found.piece[i] < 0, scene.depth.z_m[i] <= 0);
  }
  EXPECT_EQ(CellScene(0.0F).find(10).count, 0);
}

}  // namespace
}  // namespace ydd
