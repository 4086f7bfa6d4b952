// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "ydd/inference/layers.h"

namespace ydd {

/// Size of a feature map of one picture.
struct MapShape {
  int channels = 0, rows = 0, columns = 0;

  std::size_t pixels() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  }
  std::size_t size() const { return static_cast<std::size_t>(channels) * pixels(); }
  friend bool operator==(const MapShape&, const MapShape&) = default;
};

/// Sizes of all values of a network, by value, when its input is of size `input`; no channels for
/// a value that was fused away.
/// @throws std::runtime_error when maps do not fit each other, or would be larger than any picture
/// that a detector looks at needs (2^28 numbers).
std::vector<MapShape> map_shapes(const LayerGraph& graph, const MapShape& input);

/// Which values are 32-bit floats although the others are not: outputs, and what is only put
/// together into one, so that boxes do not lose the last bits.
std::vector<bool> wide_values(const LayerGraph& graph);

/// Where each value lies in one block of memory, in which values take the place of those that
/// nobody needs any longer. A sum with a residual is computed where the residual lies.
struct ValuePlaces {
  std::vector<std::size_t> offset_bytes;  ///< by value
  std::size_t size_bytes = 0;
};
/// `value_bytes` is the size of each value.
ValuePlaces place_values(const LayerGraph& graph, const std::vector<std::size_t>& value_bytes);

}  // namespace ydd
