// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ydd/base/options.h"
#include "ydd/features/features.h"
#include "ydd/image/image.h"

namespace ydd {

/// How corners are found; describe() has the sentences.
struct OrbOptions {
  int levels = 8;
  double scale_step = 1.2;
  int fast_threshold = 20;
  int fast_threshold_low = 7;
  int threads = 1;
  void describe(OptionTable& table);
};

/// Oriented FAST corners with steered BRIEF descriptors over an image pyramid.
/// Rublee et al., "ORB: an efficient alternative to SIFT or SURF", ICCV 2011.
///
/// Thread: one call at a time (buffers are reused from call to call). Deterministic, also with
/// several threads.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options);  ///< Buffers are taken with the first image.
  ~OrbExtractor();
  OrbExtractor(OrbExtractor&&) noexcept;
  OrbExtractor& operator=(OrbExtractor&&) noexcept;

  /// About `target` features, spread evenly over image and levels. An image smaller than 64x64 px
  /// gives none.
  OrbFeatures extract(const GreyImage& grey, int target);

 private:
  struct Workspace;
  OrbOptions options_;
  std::unique_ptr<Workspace> work_;
};

}  // namespace ydd
