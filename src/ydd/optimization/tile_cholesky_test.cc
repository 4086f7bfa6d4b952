// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/tile_cholesky.h"

#include <algorithm>
#include <random>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace ydd {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

/// Coupled neighbours along a path, and what `extra` couples (row > col).
Pairs path_with(int blocks, int band, const Pairs& extra) {
  Pairs pairs = extra;
  for (int row = 0; row < blocks; ++row) {
    for (int col = std::max(0, row - band); col < row; ++col) pairs.emplace_back(row, col);
  }
  return pairs;
}

struct FactorCase {
  const char* name;
  int blocks;
  int band;
  Pairs extra;
};

class TileCholeskyOf : public testing::TestWithParam<FactorCase> {};

TEST_P(TileCholeskyOf, SolvesAsADenseFactorisationDoes) {
  const auto& [name, blocks, band, extra] = GetParam();
  const Pairs pairs = path_with(blocks, band, extra);
  TileCholesky::Pattern pattern(blocks);
  for (const auto& [row, col] : pairs) pattern.add(row, col);
  TileCholesky tiles(std::move(pattern));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int round = 0; round < 2; ++round) {  // the second use must not see the first
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 * blocks, 6 * blocks);
    for (const auto& [row, col] : pairs) {
      const Matrix6d value = Matrix6d::NullaryExpr([&] { return unit(random); });
      dense.block<6, 6>(6 * row, 6 * col) = value;
      dense.block<6, 6>(6 * col, 6 * row) = value.transpose();
    }
    dense.diagonal() = dense.cwiseAbs().rowwise().sum().array() + 0.5;  // dominant: definite
    tiles.clear();
    for (const auto& [row, col] : pairs) {
      tiles.block(row, col) = dense.block<6, 6>(6 * row, 6 * col);
    }
    for (int i = 0; i < blocks; ++i) tiles.block(i, i) = dense.block<6, 6>(6 * i, 6 * i);
    const Eigen::VectorXd rhs =
        Eigen::VectorXd::NullaryExpr(6 * blocks, [&] { return unit(random); });
    ASSERT_TRUE(tiles.factorise());
    const Eigen::VectorXd x = tiles.solve(rhs);
    EXPECT_LT((dense * x - rhs).norm(), 1e-12 * rhs.norm());
    EXPECT_LT((x - dense.llt().solve(rhs)).norm(), 1e-12 * x.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(
    TileCholesky, TileCholeskyOf,
    testing::Values(FactorCase{"One", 1, 0, {}}, FactorCase{"OneTile", 8, 7, {}},
                    FactorCase{"OneMore", 9, 8, {}}, FactorCase{"Band", 45, 5, {}},
                    FactorCase{"Loop", 45, 3, {{44, 0}, {43, 2}, {30, 9}}},
                    FactorCase{"Full", 25, 25, {}}, FactorCase{"Separate", 20, 0, {}}),
    [](const auto& c) { return c.param.name; });

TEST(TileCholesky, SaysWhenTheMatrixIsNotPositiveDefinite) {
  TileCholesky tiles{TileCholesky::Pattern(10)};
  tiles.clear();
  for (int i = 0; i < 10; ++i) tiles.block(i, i) = Matrix6d(Matrix6d::Identity());
  ASSERT_TRUE(tiles.factorise());
  tiles.clear();
  for (int i = 0; i < 10; ++i) tiles.block(i, i) = Matrix6d(Matrix6d::Identity());
  tiles.block(9, 9)(3, 3) = -1.0;
  EXPECT_FALSE(tiles.factorise());
}

TEST(TileCholesky, NothingToSolveIsSolved) {
  TileCholesky tiles{TileCholesky::Pattern(0)};
  tiles.clear();
  EXPECT_TRUE(tiles.factorise());
  EXPECT_EQ(tiles.solve(Eigen::VectorXd()).size(), 0);
}

}  // namespace
}  // namespace ydd
