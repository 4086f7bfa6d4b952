// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "ydd/features/features.h"

namespace ydd {

/// Keypoints of one image sorted into square cells of their undistorted position, for area queries.
class KeypointGrid {
 public:
  KeypointGrid() = default;
  KeypointGrid(const Features& features, const Camera& camera);

  /// Appends to `out` (cleared first) the indices of keypoints with |dx| < radius and |dy| < radius
  /// of (x, y), all in undistorted pixels, in increasing cell order, on octaves
  /// [min_octave, max_octave].
  void query(float x_px, float y_px, float radius_px, int min_octave, int max_octave,
             std::vector<int>& out) const;

 private:
  static constexpr float kCell_px = 16.0F;
  float origin_x_px_ = 0, origin_y_px_ = 0;
  int columns_ = 0, rows_ = 0;
  /// What a query asks of a keypoint, side by side: queries are where tracking reads most.
  struct Entry {
    float x_px, y_px;
    std::uint32_t index : 24;
    std::uint32_t octave : 8;
  };
  std::vector<int> start_;      ///< columns * rows + 1 offsets into entries_
  std::vector<Entry> entries_;  ///< by cell
};

/// Nearest and second nearest of some candidates.
struct BestMatch {
  int index = -1;      ///< into the features; -1: no candidate
  int distance = 257;  ///< Hamming
  int second_distance = 257;
  int octave = -1;         ///< of the best
  int second_octave = -1;  ///< of the second best
};
BestMatch best_match(const Descriptor& query, const Features& features,
                     std::span<const int> candidates);

/// Rejects matches whose rotation disagrees: keeps the three fullest of 30 bins of angle
/// differences (a bin below a tenth of the fullest is dropped). `angle_differences_rad` and the
/// result are parallel: true means keep.
std::vector<bool> consistent_rotation(std::span<const float> angle_differences_rad);

/// The descriptor whose median distance to the others is least; ties go to the first. Not empty.
Descriptor median_descriptor(std::span<const Descriptor> descriptors);

}  // namespace ydd
