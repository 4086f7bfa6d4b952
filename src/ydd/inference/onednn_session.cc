// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "ydd/inference/layers.h"
#include "ydd/inference/network_backends.h"

#ifdef YDD_WITH_ONEDNN
#include "ydd/inference/layer_shapes.h"
#include "ydd/inference/onednn_plan.h"
#include "ydd/inference/quantisation.h"

namespace ydd {
namespace {

/// Keeps a plan for the newest shape of input: a detector has one.
class OnednnSession : public InferenceSession {
 public:
  OnednnSession(LayerGraph graph, PlanOptions options)
      : graph_(std::move(graph)), options_(std::move(options)) {}

  Result<std::vector<Tensor>> run(const Tensor& input) override {
    try {
      if (!plan_ || input.shape != shape_) {
        plan_.reset();
        plan_ = std::make_unique<OnednnPlan>(graph_, input.shape, options_);
        shape_ = input.shape;
      }
      return plan_->run(input);
    } catch (const std::exception& e) {  // dnnl::error among them
      return Error{
          fmt::format("cannot take an input of {}: {}", format_shape(input.shape), e.what())};
    }
  }

 private:
  LayerGraph graph_;
  PlanOptions options_;
  std::vector<int> shape_;
  std::unique_ptr<OnednnPlan> plan_;
};

MapNumbers numbers_of(Precision precision) {
  if (precision == Precision::int8) return MapNumbers::int8;
  const bool bfloat16 = precision == Precision::bfloat16 ||
                        (precision == Precision::automatic && onednn_has_quick_bfloat16());
  return bfloat16 ? MapNumbers::bfloat16 : MapNumbers::float32;
}

}  // namespace

SessionResult make_onednn_session(std::string_view onnx, const InferenceOptions& options) {
  if (options.precision == Precision::float16)
    return Error{"precision float16 needs 'device: cuda'"};
  if (options.precision == Precision::bfloat16 && !onednn_has_bfloat16()) {
    return Error{"precision bfloat16 needs a processor with AVX-512"};
  }
  if (options.precision == Precision::int8 && !onednn_has_int8()) {
    return Error{"precision int8 needs oneDNN 2, this build has 3"};
  }
  Result<OnnxGraph> graph = read_onnx(onnx);
  if (!graph) return Error{"oneDNN cannot load it: " + graph.error().message};
  Result<LayerGraph> layers = make_layers(std::move(*graph));
  if (!layers) return Error{"oneDNN cannot load it: " + layers.error().message};
  if (!onednn_has_kernels()) return Error{"oneDNN has no kernels for this processor"};
  const MapNumbers numbers = numbers_of(options.precision);
  if (numbers == MapNumbers::int8) {
    const auto steps = value_steps(*layers, wide_values(*layers), options.ranges);
    if (!steps) return steps.error();
  }
  return std::unique_ptr<InferenceSession>(std::make_unique<OnednnSession>(
      std::move(*layers), PlanOptions{numbers, options.threads, options.ranges}));
}

}  // namespace ydd

#else

namespace ydd {
SessionResult make_onednn_session(std::string_view, const InferenceOptions&) {
  return Error{"this build has no oneDNN (Debian package libdnnl-dev); use 'backend: opencv'"};
}
}  // namespace ydd

#endif
