// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/seen_space.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/evidence/evidence_testing.h"

namespace ydd {
namespace {

using testing::Each;

class SpaceView {
 public:
  explicit SpaceView(float z_m) : pixels_(std::size_t{160} * 120, z_m) {}
  /// In cells.
  SpaceView& paint(int column0, int row0, int column1, int row1, float z_m) {
    for (int y = 8 * row0; y < 8 * row1; ++y) {
      for (int x = 8 * column0; x < 8 * column1; ++x) {
        pixels_[static_cast<std::size_t>(y * 160 + x)] = z_m;
      }
    }
    return *this;
  }
  SpaceView& shake(float sigma_m, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0, sigma_m);
    for (float& z_m : pixels_) z_m += noise(random);
    return *this;
  }
  CoarseDepth coarse() const { return coarse_depth({160, 120, pixels_}, 8); }

 private:
  std::vector<float> pixels_;
};

std::vector<Space> space_of(const SpaceView& now, const SpaceView& then,
                            const SE3& T_then_now = SE3()) {
  const Camera camera = evidence_testing::small_camera();
  const std::vector<Eigen::Vector2f> rays = cell_rays(camera, CellGrid(160, 120, 8));
  SeenFrom::Places places;
  std::vector<Space> space;
  space_then(points_on(rays, now.coarse().z_m), then.coarse(), T_then_now, camera, {}, places,
             space);
  return space;
}

SE3 shifted(double x_m, double y_m, double z_m) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, y_m, z_m)};
}

Space at_cell(const std::vector<Space>& space, int column, int row) {
  return space[static_cast<std::size_t>(row * 20 + column)];
}

TEST(SpaceThen, TheSameWallIsTheSame) {
  EXPECT_THAT(space_of(SpaceView(2.0F), SpaceView(2.0F)), Each(Space::same));
}

TEST(SpaceThen, ABoxBeforeTheWallIsWhereNothingWas) {
  const std::vector<Space> space =
      space_of(SpaceView(2.0F).paint(8, 5, 12, 9, 1.2F), SpaceView(2.0F));
  for (int row = 0; row < 15; ++row) {
    for (int column = 0; column < 20; ++column) {
      const bool box = column >= 8 && column < 12 && row >= 5 && row < 9;
      EXPECT_EQ(at_cell(space, column, row), box ? Space::empty : Space::same)
          << column << ' ' << row;
    }
  }
}

TEST(SpaceThen, AnUncoveredWallWasHidden) {
  const std::vector<Space> space =
      space_of(SpaceView(2.0F), SpaceView(2.0F).paint(8, 5, 12, 9, 1.2F));
  for (int row = 0; row < 15; ++row) {
    for (int column = 0; column < 20; ++column) {
      const bool box = column >= 8 && column < 12 && row >= 5 && row < 9;
      const bool inside = column >= 9 && column < 11 && row >= 6 && row < 8;
      EXPECT_EQ(at_cell(space, column, row), inside ? Space::hidden
                                             : box  ? Space::unknown
                                                    : Space::same)
          << column << ' ' << row;
    }
  }
}

TEST(SpaceThen, OutOfViewIsUnknown) {
  EXPECT_THAT(space_of(SpaceView(2.0F), SpaceView(2.0F), shifted(10, 0, 0)), Each(Space::unknown));
  EXPECT_THAT(space_of(SpaceView(2.0F), SpaceView(2.0F), shifted(0, 0, -3)), Each(Space::unknown))
      << "behind the camera";
}

TEST(SpaceThen, HolesAreUnknown) {
  const SpaceView wall(2.0F);
  const SpaceView holed = SpaceView(2.0F).paint(6, 4, 14, 11, 0.0F);
  EXPECT_EQ(at_cell(space_of(wall, holed), 10, 7), Space::unknown);
  EXPECT_EQ(at_cell(space_of(holed, wall), 10, 7), Space::unknown);
  EXPECT_EQ(at_cell(space_of(wall, holed), 3, 7), Space::same);
  EXPECT_EQ(at_cell(space_of(SpaceView(2.0F).paint(6, 4, 14, 11, 1.0F), holed), 10, 7),
            Space::unknown)
      << "nobody saw that it was empty";
}

TEST(SpaceThen, NoiseOfAFarWallIsNoEvidence) {
  const float sigma_m = EvidenceOptions().noise.sigma_m(5.0F);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::vector<Space> space =
        space_of(SpaceView(5.0F).shake(sigma_m, seed), SpaceView(5.0F).shake(sigma_m, 100 + seed));
    EXPECT_EQ(std::ranges::count(space, Space::empty), 0) << seed;
    EXPECT_EQ(std::ranges::count(space, Space::hidden), 0) << seed;
    EXPECT_GT(std::ranges::count(space, Space::same), 290) << seed;
  }
}

TEST(SpaceThen, ToleranceGrowsWithTheSensorsNoise) {
  EXPECT_THAT(space_of(SpaceView(4.88F), SpaceView(5.0F)), Each(Space::same));
  EXPECT_THAT(space_of(SpaceView(4.70F), SpaceView(5.0F)), Each(Space::empty));
  EXPECT_THAT(space_of(SpaceView(0.88F), SpaceView(1.0F)), Each(Space::empty));
}

TEST(SpaceThen, FollowsACameraThatWentForward) {
  const std::vector<Space> space = space_of(SpaceView(1.7F), SpaceView(2.0F), shifted(0, 0, 0.3));
  EXPECT_THAT(space, Each(Space::same));
  EXPECT_THAT(space_of(SpaceView(1.7F), SpaceView(2.0F)), Each(Space::empty));
}

TEST(SpaceThen, FollowsACameraThatWentAside) {
  // 0.2 m to the right: what is at 1 m goes four cells to the left, the wall at 2 m two.
  const std::vector<Space> space =
      space_of(SpaceView(2.0F).paint(4, 5, 8, 9, 1.0F), SpaceView(2.0F).paint(8, 5, 12, 9, 1.0F),
               shifted(0.2, 0, 0));
  EXPECT_EQ(std::ranges::count(space, Space::empty), 0);
  for (int row = 5; row < 9; ++row) {
    for (int column = 4; column < 8; ++column) {
      EXPECT_EQ(at_cell(space, column, row), Space::same);
    }
  }
  EXPECT_EQ(at_cell(space, 8, 7), Space::hidden) << "the box stood before it";
  EXPECT_EQ(at_cell(space, 15, 7), Space::same);
  EXPECT_EQ(at_cell(space, 18, 7), Space::unknown) << "newly in view";
}

}  // namespace
}  // namespace ydd
