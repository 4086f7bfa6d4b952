// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/tile_cholesky.h"

#include <utility>

#include <Eigen/Cholesky>

namespace ydd {

TileCholesky::Pattern::Pattern(int blocks)
    : blocks_(blocks),
      tiles_((blocks + kBlocks - 1) / kBlocks),
      used_(static_cast<std::size_t>(tiles_) * tiles_, false) {
  for (int i = 0; i < tiles_; ++i) at(i, i) = true;
}

void TileCholesky::Pattern::fill() {
  std::vector<int> rows;
  for (int col = 0; col < tiles_; ++col) {
    rows.clear();
    for (int row = col + 1; row < tiles_; ++row) {
      if (at(row, col)) rows.push_back(row);
    }
    for (std::size_t a = 0; a < rows.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) at(rows[a], rows[b]) = true;
    }
  }
}

TileCholesky::TileCholesky(Pattern pattern)
    : blocks_(pattern.blocks()), tiles_(pattern.tiles()), rows_below_(tiles_) {
  pattern.fill();
  index_.assign(static_cast<std::size_t>(tiles_) * tiles_, -1);
  int count = 0;
  for (int col = 0; col < tiles_; ++col) {
    for (int row = col; row < tiles_; ++row) {
      if (!pattern.at(row, col)) continue;
      index_[row * tiles_ + col] = count++;
      if (row > col) rows_below_[col].push_back(row);
    }
  }
  tile_data_.resize(count);
}

void TileCholesky::clear() {
  for (Tile& t : tile_data_) t.setZero();
  const int rest = tiles_ * kSide - 6 * blocks_;  // the last tile's unused rows
  if (rest > 0) tile(tiles_ - 1, tiles_ - 1).diagonal().tail(rest).setOnes();
}

bool TileCholesky::factorise() {
  for (int col = 0; col < tiles_; ++col) {
    if (!factorise_diagonal(col)) return false;
    update_right_of(col);
  }
  return true;
}

bool TileCholesky::factorise_diagonal(int at) {
  Eigen::Ref<Tile> diagonal = tile(at, at);
  const Eigen::LLT<Eigen::Ref<Tile>, Eigen::Lower> llt(diagonal);  // in place
  return llt.info() == Eigen::Success;
}

void TileCholesky::update_right_of(int col) {
  const std::vector<int>& rows = rows_below_[col];
  const Tile& diagonal = tile(col, col);
  for (const int row : rows) {
    diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(
        tile(row, col));
  }
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const Tile& left = tile(rows[a], col);
    for (std::size_t b = 0; b <= a; ++b) {
      tile(rows[a], rows[b]).noalias() -= left * tile(rows[b], col).transpose();
    }
  }
}

Eigen::VectorXd TileCholesky::solve(const Eigen::VectorXd& rhs) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(tiles_ * kSide);
  x.head(rhs.size()) = rhs;
  for (int col = 0; col < tiles_; ++col) {
    auto part = x.segment<kSide>(col * kSide);
    const Eigen::Ref<const Eigen::MatrixXd> diagonal = tile(col, col);
    diagonal.triangularView<Eigen::Lower>().solveInPlace(part);
    for (const int row : rows_below_[col]) {
      x.segment<kSide>(row * kSide).noalias() -= tile(row, col) * part;
    }
  }
  for (int col = tiles_ - 1; col >= 0; --col) {
    auto part = x.segment<kSide>(col * kSide);
    for (const int row : rows_below_[col]) {
      const Eigen::Ref<const Eigen::MatrixXd> below = tile(row, col);
      part.noalias() -= below.transpose() * x.segment<kSide>(row * kSide);
    }
    const Eigen::Ref<const Eigen::MatrixXd> diagonal = tile(col, col);
    diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace(part);
  }
  return x.head(rhs.size());
}

}  // namespace ydd
