// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ydd/geometry/se3.h"

namespace ydd {

/// Cholesky factorisation of a symmetric positive definite matrix of 6x6 blocks, stored as dense
/// tiles of 8x8 blocks of which empty ones are left out.
///
/// In between dense and sparse solvers: few poses make few tiles, that is a dense factorisation; a
/// long path makes a band, to which each return to a known place adds rows of tiles. The order is
/// that of the blocks: keyframes follow each other in time, which keeps the band narrow. Right-
/// looking, tile by tile (Golub, van Loan, Matrix computations, section 4.2); deterministic.
class TileCholesky {
 public:
  static constexpr int kBlocks = 8;  ///< blocks along a tile's side
  static constexpr int kSide = 6 * kBlocks;
  using Tile = Eigen::Matrix<double, kSide, kSide>;
  using Block = Eigen::Map<Matrix6d, Eigen::Unaligned, Eigen::OuterStride<kSide>>;

  /// Which tiles are not empty; row >= col.
  class Pattern {
   public:
    explicit Pattern(int blocks);
    void add(int row_block, int col_block) { at(row_block / kBlocks, col_block / kBlocks) = true; }
    int blocks() const { return blocks_; }
    int tiles() const { return tiles_; }
    std::vector<bool>::reference at(int row, int col) { return used_[row * tiles_ + col]; }
    /// Adds the tiles that factorising fills.
    void fill();

   private:
    int blocks_;
    int tiles_;
    std::vector<bool> used_;
  };

  explicit TileCholesky(Pattern pattern);

  /// Forgets matrix and factor: all blocks are zero again.
  void clear();
  /// The block to be written, row >= col; of diagonal blocks the lower triangle counts. The tile
  /// must be in the pattern.
  Block block(int row, int col) {
    const int tile = index_[(row / kBlocks) * tiles_ + col / kBlocks];
    return Block(tile_data_[tile].data() + (row % kBlocks) * 6 +
                     static_cast<std::ptrdiff_t>((col % kBlocks) * 6) * kSide,
                 Eigen::OuterStride<kSide>());
  }
  /// Replaces the matrix by its factor. False when it is not positive definite.
  bool factorise();
  /// Solution for a right-hand side of 6 numbers per block; after `factorise`.
  Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;

 private:
  Tile& tile(int row, int col) { return tile_data_[index_[row * tiles_ + col]]; }
  const Tile& tile(int row, int col) const { return tile_data_[index_[row * tiles_ + col]]; }
  bool factorise_diagonal(int at);
  void update_right_of(int col);

  int blocks_;
  int tiles_;
  std::vector<int> index_;                    ///< of each tile; -1: empty
  std::vector<std::vector<int>> rows_below_;  ///< per tile column, of tiles below the diagonal
  std::vector<Tile> tile_data_;
};

}  // namespace ydd
