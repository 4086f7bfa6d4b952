// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/occupancy_grid.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/cloud/keyframe_picture.h"
#include "ydd/geometry/world_up.h"

namespace ydd {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kFloor_m = 1.2;  // below the first camera; the world's y points down

struct Block {
  Vector3d low, high;
};

/// A floor, a wall ahead at 3.2 m, a box 0.6 m high at 2 m, a lamp 2.2 m above the floor, a table
/// to the right whose top is 0.75 m high.
std::vector<Block> furnished() {
  return {{{-5, kFloor_m, -5}, {5, kFloor_m + 0.1, 5}},
          {{-5, -2, 3.2}, {5, kFloor_m, 3.3}},
          {{-0.3, kFloor_m - 0.6, 1.8}, {0.3, kFloor_m, 2.2}},
          {{-1.2, -1.3, 2.2}, {-0.8, -1.0, 2.6}},
          {{0.7, kFloor_m - 0.78, 1.6}, {1.5, kFloor_m - 0.75, 2.4}}};
}

/// Depth along the ray (direction with z = 1 in the camera frame); 0: nothing.
double cast(const std::vector<Block>& blocks, const Vector3d& from, const Vector3d& ray) {
  double nearest = 1e9;
  for (const Block& block : blocks) {
    double enter = 0, leave = 1e9;
    for (int k = 0; k < 3; ++k) {
      const double a = (block.low[k] - from[k]) / ray[k], b = (block.high[k] - from[k]) / ray[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter <= leave && enter > 0) nearest = std::min(nearest, enter);
  }
  return nearest < 1e8 ? nearest : 0;
}

/// Cameras side by side that look ahead and `pitch_rad` down.
class Room : public testing::Test {
 protected:
  void look(double pitch_rad) {
    map_ = atlas_.new_map();
    for (const double x_m : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
      const SE3 T(Eigen::Quaterniond(Eigen::AngleAxisd(-pitch_rad, Vector3d::UnitX())),
                  {x_m, 0, -0.3});
      KeyFrame keyframe;
      keyframe.shared_features = std::make_shared<const Features>();
      keyframe.map = map_;
      keyframe.T_world_camera = T;
      keyframe.picture = std::make_shared<const KeyFramePicture>(make_keyframe_picture(seen(T)));
      atlas_.add_keyframe(std::move(keyframe));
    }
  }
  static Camera lens() {
    Camera camera;
    camera.width_px = 320;
    camera.height_px = 240;
    camera.fx_px = camera.fy_px = 200;
    camera.cx_px = 159.5;
    camera.cy_px = 119.5;
    return camera;
  }
  PictureSource seen(const SE3& T) const {
    std::vector<float> depth_m;
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const Vector3d ray = lens().unproject({double(x), double(y)}, 1.0);
        const double z_m = cast(blocks_, T.translation(), T.rotation() * ray);
        depth_m.push_back(z_m < 6 ? static_cast<float>(z_m) : 0.0F);
      }
    }
    return {ColourImage(320, 240, std::vector<Bgr>(320 * 240, Bgr{90, 90, 90})),
            DepthImage(320, 240, std::move(depth_m)),
            {}};
  }
  OccupancyGrid grid(const GridOptions& options = {}) const {
    const FloorPlane floor = floor_of_map(atlas_, map_, options.cloud).value();
    return occupancy_grid(atlas_, map_, level_frame(floor), options).value();
  }
  /// The cell at a place of the world.
  static Cell at(const OccupancyGrid& grid, double x_m, double z_m) {
    const Vector3d p = grid.T_grid_world * Vector3d(x_m, kFloor_m, z_m);
    const Eigen::Vector2d cell = (p.head<2>() - grid.origin_m) / grid.resolution_m;
    const int column = static_cast<int>(std::floor(cell.x()));
    const int row = static_cast<int>(std::floor(cell.y()));
    if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) return Cell::unknown;
    return grid.at(column, row);
  }

  std::vector<Block> blocks_ = furnished();
  Atlas atlas_{lens(), PyramidScales::make(8, 1.2)};
  MapId map_;
};

TEST_F(Room, TheGridIsTheFloorAsItIsFurnished) {
  look(0.35);
  const OccupancyGrid g = grid();
  EXPECT_EQ(at(g, 0.0, 1.82), Cell::occupied) << "the box's front";
  EXPECT_EQ(at(g, -0.8, 3.22), Cell::occupied) << "the wall";
  EXPECT_EQ(at(g, 1.1, 2.0), Cell::occupied) << "the table's top";
  EXPECT_EQ(at(g, -1.0, 2.4), Cell::vacant) << "the lamp is high enough to pass under";
  EXPECT_EQ(at(g, 0.0, 1.4), Cell::vacant) << "the floor before the box";
  EXPECT_EQ(at(g, -0.6, 2.6), Cell::vacant) << "the floor beside the box";
  EXPECT_EQ(at(g, 0.0, 3.6), Cell::unknown) << "behind the wall";
  EXPECT_EQ(at(g, 0.0, -1.5), Cell::unknown) << "behind the cameras";
}

TEST_F(Room, HeightLimitsDecideWhatIsAnObstacle) {
  look(0.35);
  GridOptions low;
  low.max_height_m = 0.65;
  EXPECT_EQ(at(grid(low), 0.0, 1.82), Cell::occupied) << "the box";
  EXPECT_NE(at(grid(low), 1.1, 2.0), Cell::occupied) << "a robot fits under the table";
  GridOptions high;
  high.min_height_m = 0.68;
  EXPECT_NE(at(grid(high), 0.0, 1.82), Cell::occupied) << "it rolls over the box";
  EXPECT_EQ(at(grid(high), 1.1, 2.0), Cell::occupied);
}

TEST_F(Room, LookingAcrossFreesNothing) {
  look(0.0);  // the floor before the wall is seen from 1.7 m on only
  blocks_.clear();
  const OccupancyGrid g = grid();
  EXPECT_EQ(at(g, 0.0, 0.4), Cell::unknown) << "rays pass high above it";
  EXPECT_EQ(at(g, -0.9, 2.9), Cell::vacant) << "there it was seen";
}

TEST_F(Room, FloorIsFoundWhereItIsAlsoWithATiltedFirstCamera) {
  look(0.35);
  const FloorPlane floor = floor_of_map(atlas_, map_, {}).value();
  ASSERT_TRUE(floor.found);
  EXPECT_LT(std::acos(std::min(1.0, floor.up.dot(Vector3d(0, -1, 0)))), 0.01);
  EXPECT_NEAR(floor.height_m, -kFloor_m, 0.01);
  const SE3 T_level_world = level_frame(floor);
  EXPECT_NEAR((T_level_world * Vector3d(0.3, kFloor_m, 2)).z(), 0, 0.02);
  EXPECT_NEAR((T_level_world * Vector3d(0, 0, 1)).x(), 1, 0.02) << "ahead";
  EXPECT_NEAR((T_level_world * Vector3d(-1, 0, 0)).y(), 1, 0.02) << "to the left";
}

TEST_F(Room, ATableIsNoFloor) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::normal_distribution<float> noise(0, 0.01F);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 4000; ++i) {  // a large table, and a floor of which little was seen
    points.push_back({unit(random), 0.4F + noise(random), 2 + unit(random)});
    if (i % 8 == 0) points.push_back({2 * unit(random), 1.15F + noise(random), 2 + unit(random)});
  }
  const FloorPlane floor = find_floor(points, {0, -1, 0});
  ASSERT_TRUE(floor.found);
  EXPECT_NEAR(floor.height_m, -1.15, 0.02);
}

TEST(FloorPlane, WithoutOneTheLowestPointsAreTaken) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Eigen::Vector3f> wall;
  for (int i = 0; i < 4000; ++i) wall.push_back({2 * unit(random), unit(random), 3.0F});
  const FloorPlane floor = find_floor(wall, {0, -1, 0});
  EXPECT_FALSE(floor.found);
  EXPECT_NEAR(floor.height_m, -1, 0.05);
  EXPECT_FALSE(find_floor({}, {0, -1, 0}).found);
}

TEST_F(Room, IsTheSameEveryTime) {
  look(0.35);
  EXPECT_EQ(format_pgm(grid()), format_pgm(grid()));
}

TEST_F(Room, TooManyCellsAreRefused) {
  look(0.35);
  GridOptions fine;
  fine.resolution_m = 0.0005;
  const auto g = occupancy_grid(atlas_, map_, SE3(), fine);
  ASSERT_FALSE(g);
  EXPECT_THAT(g.error().message, HasSubstr("choose larger cells"));
}

TEST_F(Room, AMapWithoutPicturesHasNoGrid) {
  map_ = atlas_.new_map();
  EXPECT_TRUE(occupancy_grid(atlas_, map_, SE3(), {}).value().empty());
}

TEST(OccupancyGrid, FilesAreAsMapServerReadsThem) {
  OccupancyGrid g;
  g.columns = 3;
  g.rows = 2;
  g.origin_m = {-1, 2};
  g.cells = {Cell::vacant,   Cell::occupied, Cell::unknown,
             Cell::occupied, Cell::occupied, Cell::vacant};
  const std::string pgm = format_pgm(g);
  EXPECT_THAT(pgm, StartsWith("P5\n# 0.05 m/cell\n3 2\n255\n"));
  const std::string pixels = pgm.substr(pgm.size() - 6);  // the upper row comes first
  const std::vector<int> expected = {0, 0, 254, 254, 0, 205};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(static_cast<unsigned char>(pixels[i]), expected[i]) << i;
  }
  const std::string yaml = format_map_yaml(g, "it's.pgm");
  EXPECT_THAT(yaml, StartsWith("image: 'it''s.pgm'\nresolution: 0.05\norigin: [-1.000000, "
                               "2.000000, 0.0]\nnegate: 0\n"));
}

}  // namespace
}  // namespace ydd
