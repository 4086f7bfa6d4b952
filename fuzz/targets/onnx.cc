// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/inference/layer_shapes.h"
#include "ydd/inference/network.h"
#include "ydd/inference/onednn_plan.h"

namespace ydd::fuzz {
namespace {

/// Multiplications of a network: whether it is worth running here.
double work(const LayerGraph& graph, const std::vector<MapShape>& shapes) {
  double work = 0;
  for (const Layer& layer : graph.layers) {
    double each = 1;
    for (std::size_t i = 1; i < layer.weights.dims.size(); ++i) {
      each *= static_cast<double>(layer.weights.dims[i]);
    }
    const Window& w = layer.window;
    if (layer.kind == LayerKind::max_pool) each = static_cast<double>(w.kernel[0]) * w.kernel[1];
    work += each * static_cast<double>(shapes.at(static_cast<std::size_t>(layer.output)).size());
  }
  return work;
}

}  // namespace

void onnx(std::string_view input) {
  expect_one_line(check_onnx(input));
  Result<OnnxGraph> graph = read_onnx(input);
  expect_one_line(graph);
  if (!graph) return;
  const Result<LayerGraph> layers = make_layers(*std::move(graph));
  expect_one_line(layers);
  if (!layers) return;
  constexpr MapShape kInput{3, 32, 64};
  try {
    const std::vector<MapShape> shapes = map_shapes(*layers, kInput);
    std::vector<std::size_t> bytes;
    for (const MapShape& shape : shapes) bytes.push_back(shape.size() * sizeof(float));
    place_values(*layers, bytes);
#ifdef YDD_WITH_ONEDNN
    constexpr double kMostWork = 1e7;
    if (work(*layers, shapes) > kMostWork) return;
    const std::vector<float> pixels(kInput.size(), 1.0F);
    const std::vector<int> shape = {1, kInput.channels, kInput.rows, kInput.columns};
    OnednnPlan(*layers, shape, {}).run({shape, pixels});
#endif
  } catch (const std::logic_error&) {
    throw;                           // a broken invariant
  } catch (const std::exception&) {  // maps that do not fit each other; what oneDNN does not do
  }
}

}  // namespace ydd::fuzz
