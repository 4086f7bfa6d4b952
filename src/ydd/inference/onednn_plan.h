// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ydd/inference/layers.h"
#include "ydd/inference/network.h"

namespace ydd {

/// In which numbers feature maps are kept; outputs are 32-bit floats.
enum class MapNumbers { float32, bfloat16, int8 };

/// How a network is made ready.
struct PlanOptions {
  MapNumbers numbers = MapNumbers::float32;
  int threads = 1;
  std::vector<float> ranges{};  ///< for int8: as for value_steps()
};

/// Whether oneDNN has quick kernels for this processor at all. Debian's has none for ARM without
/// SVE.
bool onednn_has_kernels();
bool onednn_has_int8();            ///< version 2; version 3 takes scales in another way
bool onednn_has_bfloat16();        ///< with AVX-512
bool onednn_has_quick_bfloat16();  ///< with AMX; without it 32-bit floats are quicker

/// A network made ready for one shape of input: kernels chosen, weights laid out once, one block of
/// memory in which values take the place of those that nobody needs any longer.
///
/// Feature maps lie channels last ({1, rows, columns, channels}): the layout for which oneDNN has
/// AMX kernels; with 32-bit floats it costs a few per cent against blocked layouts (ADR 7).
class OnednnPlan {
 public:
  /// Keeps nothing of `graph`. @throws std::exception when shapes do not fit each other, or where
  /// oneDNN has no kernel.
  OnednnPlan(const LayerGraph& graph, const std::vector<int>& input_shape,
             const PlanOptions& options);
  ~OnednnPlan();
  OnednnPlan(const OnednnPlan&) = delete;
  OnednnPlan& operator=(const OnednnPlan&) = delete;

  /// All outputs, valid until the next call.
  std::vector<Tensor> run(const Tensor& input);

  /// Which implementation oneDNN runs for each of its primitives, in their order ("jit:avx2").
  const std::vector<std::string>& implementations() const;

 private:
  struct Parts;
  int threads_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace ydd
