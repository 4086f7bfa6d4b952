// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/frame_source.h"

#include <utility>

namespace ydd {

void PrefetchOptions::describe(OptionTable& table) {
  table.add("depth", depth, {1, 100}, "frames", "frames decoded ahead of tracking");
  table.add("workers", workers, {0, 16}, "",
            "threads that decode ahead; 0: decode when a frame is wanted");
}

FrameSource::FrameSource(Sequence sequence, const Camera& camera, const PrefetchOptions& options)
    : sequence_(std::make_shared<const Sequence>(std::move(sequence))) {
  prefetcher_ = std::make_unique<Prefetcher<Result<RgbdFrame>>>(
      sequence_->size(), static_cast<std::size_t>(options.depth),
      static_cast<std::size_t>(options.workers),
      [recording = sequence_, camera](std::size_t i) { return recording->read(i, camera); });
}

}  // namespace ydd
