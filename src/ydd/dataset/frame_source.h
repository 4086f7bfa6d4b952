// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "ydd/base/prefetcher.h"
#include "ydd/base/result.h"
#include "ydd/dataset/sequence.h"

namespace ydd {

/// How far frames are decoded ahead.
struct PrefetchOptions {
  int depth = 4;    ///< decoded frames that wait (2.5 MB each at 640x480)
  int workers = 1;  ///< threads that decode; 0: `next` decodes itself

  void describe(OptionTable& table);
};

/// The frames of a sequence in order, decoded ahead on threads of its own: tracking waits for
/// decoding only when it is the slower of the two.
///
/// Thread: `next` is for one thread.
class FrameSource {
 public:
  /// Decoding starts at once.
  FrameSource(Sequence sequence, const Camera& camera, const PrefetchOptions& options = {});

  /// The next frame or why it cannot be read (the one after can then still be had); nothing after
  /// the last.
  std::optional<Result<RgbdFrame>> next() { return prefetcher_->next(); }

  /// Frames before `i` are not wanted any more, nor decoded.
  void skip_to(std::size_t i) { prefetcher_->skip_to(i); }

  const Sequence& sequence() const { return *sequence_; }  ///< The one that it reads.

 private:
  std::shared_ptr<const Sequence> sequence_;
  std::unique_ptr<Prefetcher<Result<RgbdFrame>>> prefetcher_;
};

}  // namespace ydd
