// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/alignment.h"

#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace ydd {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points random_points(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> metre(-2.0, 2.0);
  Points points;
  for (int i = 0; i < count; ++i) {
    const double z = metre(random), y = metre(random);
    points.emplace_back(metre(random), y, z);
  }
  return points;
}

const SE3 kMotion(Eigen::Quaterniond(Eigen::AngleAxisd(2.1,
                                                       Eigen::Vector3d(1, -2, 0.5).normalized())),
                  Eigen::Vector3d(0.3, -5.0, 1.2));

Points moved(const Points& points, const SE3& motion, double scale) {
  Points out;
  for (const auto& p : points) out.push_back(motion * Eigen::Vector3d(scale * p));
  return out;
}

TEST(Alignment, RecoversAnExactMotion) {
  const Points source = random_points(20, 1);
  const auto a = align_points(source, moved(source, kMotion, 1.0));
  ASSERT_TRUE(a);
  EXPECT_TRUE(a->unique);
  EXPECT_DOUBLE_EQ(a->scale, 1.0);
  EXPECT_LT((a->T_target_source.inverse() * kMotion).log().norm(), 1e-12);
  EXPECT_LT(a->rmse_m, 1e-12);
}

TEST(Alignment, RecoversScaleOnlyWhenAsked) {
  const Points source = random_points(20, 2);
  const Points target = moved(source, kMotion, 1.7);
  const auto similarity = align_points(source, target, AlignmentScale::estimated);
  const auto rigid = align_points(source, target, AlignmentScale::fixed);
  ASSERT_TRUE(similarity && rigid);
  EXPECT_NEAR(similarity->scale, 1.7, 1e-12);
  EXPECT_LT(similarity->rmse_m, 1e-12);
  EXPECT_DOUBLE_EQ(rigid->scale, 1.0);
  EXPECT_GT(rigid->rmse_m, 0.5);
  EXPECT_LT((rigid->T_target_source.rotation().angularDistance(kMotion.rotation())), 1e-9);
}

TEST(Alignment, ThreePointsAreEnough) {
  const Points source = random_points(3, 3);
  const auto a = align_points(source, moved(source, kMotion, 1.0));
  ASSERT_TRUE(a);
  EXPECT_TRUE(a->unique);
  EXPECT_LT((a->T_target_source.inverse() * kMotion).log().norm(), 1e-9);
}

TEST(Alignment, NeverGivesAReflection) {
  const Points source = random_points(30, 4);
  Points mirrored = source;
  for (auto& p : mirrored) p.x() = -p.x();
  const auto a = align_points(source, mirrored);
  ASSERT_TRUE(a);
  EXPECT_NEAR(a->T_target_source.rotation_matrix().determinant(), 1.0, 1e-12);
  EXPECT_GT(a->rmse_m, 0.1);
}

TEST(Alignment, IsOptimalUnderNoise) {
  const Points source = random_points(50, 5);
  Points target = moved(source, kMotion, 1.0);
  const Points noise = random_points(50, 6);
  for (std::size_t i = 0; i < target.size(); ++i) target[i] += 0.01 * noise[i];
  const auto a = align_points(source, target);
  ASSERT_TRUE(a);
  const auto rmse_of = [&](const SE3& T) {
    double sum = 0;
    for (std::size_t i = 0; i < source.size(); ++i)
      sum += (target[i] - T * source[i]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(source.size()));
  };
  EXPECT_NEAR(rmse_of(a->T_target_source), a->rmse_m, 1e-12);
  for (int axis = 0; axis < 6; ++axis) {
    for (const double step : {-1e-4, 1e-4}) {
      Vector6d twist = Vector6d::Zero();
      twist[axis] = step;
      EXPECT_GT(rmse_of(SE3::exp(twist) * a->T_target_source), a->rmse_m);
    }
  }
}

TEST(Alignment, DegenerateSetsAreMarked) {
  const Points line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {-1, -1, -1}};
  const auto on_line = align_points(line, moved(line, kMotion, 1.0));
  ASSERT_TRUE(on_line);
  EXPECT_FALSE(on_line->unique);
  EXPECT_LT(on_line->rmse_m, 1e-9);

  const Points still(5, Eigen::Vector3d(1, 2, 3));
  const auto standing = align_points(still, moved(still, kMotion, 1.0), AlignmentScale::estimated);
  ASSERT_TRUE(standing);
  EXPECT_FALSE(standing->unique);
  EXPECT_DOUBLE_EQ(standing->scale, 1.0);
  EXPECT_LT(standing->rmse_m, 1e-12);

  EXPECT_FALSE(align_points(Points{}, Points{}));
  EXPECT_THROW(align_points(line, still), std::logic_error);
}

TEST(Alignment, SurvivesPointsFarFromTheOrigin) {
  Points source = random_points(20, 7);
  for (auto& p : source) p += Eigen::Vector3d(1e5, -1e5, 1e5);
  const Points target = moved(source, kMotion, 1.0);
  const auto a = align_points(source, target);
  ASSERT_TRUE(a);
  EXPECT_LT(a->rmse_m, 1e-8);
}

}  // namespace
}  // namespace ydd
