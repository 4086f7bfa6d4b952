// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/inference/onnx_graph.h"

namespace ydd {

enum class LayerKind { convolution, activation, add, multiply, concat, max_pool, upsample };
enum class Activation { none, silu, sigmoid, relu, leaky_relu };

/// Parameters of windows: convolution and pooling; {rows, columns}.
struct Window {
  std::array<int, 2> kernel{1, 1}, stride{1, 1}, dilation{1, 1};
  std::array<int, 2> pad_begin{0, 0}, pad_end{0, 0};
};

/// One step of a network, with what is computed in the same pass.
struct Layer {
  LayerKind kind = LayerKind::convolution;
  std::vector<int> inputs;  ///< values, by number
  int output = 0;
  Activation activation = Activation::none;  ///< of a convolution, after it; of an activation
  float slope = 0;                           ///< of leaky_relu
  std::optional<int> residual;  ///< added after the activation; not needed by any later layer
  Window window;
  int groups = 1;
  OnnxTensor weights, bias;  ///< of a convolution; the bias may be empty
  int scale = 1;             ///< of upsample, by repetition in both directions
};

/// A network of the kinds that YOLO backbones and heads are made of. Values are feature maps
/// {1, channels, rows, columns}; value 0 is the input.
struct LayerGraph {
  std::vector<Layer> layers;  ///< in the order in which they run
  int value_count = 1;
  std::vector<int> outputs;
};

/// Translates and fuses: sigmoid and multiplication become SiLU, an activation joins the
/// convolution before it, and so does a sum whose other part nobody needs later. Fails with the
/// first operator that is of another kind.
Result<LayerGraph> make_layers(OnnxGraph graph);

/// The last layer that reads each value; layers.size() for outputs, -1 for what nobody reads.
std::vector<int> last_uses(const LayerGraph& graph);

}  // namespace ydd
