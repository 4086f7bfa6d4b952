// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ydd/matching/gathered_bundle.h"

namespace ydd {

/// How far around a keyframe is refined.
struct LocalBundleOptions {
  BundleOptions solver;
  int max_free_keyframes = 30;
  int max_fixed_keyframes = 60;
  void describe(OptionTable& table);
};

/// The keyframe and those that share most points with it are free, all points they see are free,
/// other keyframes that see these points hold the frame of reference. Those of `along` are free,
/// too.
GatheredBundle gather_local_bundle(const Atlas& atlas, KeyFrameId keyframe,
                                   const LocalBundleOptions& options,
                                   std::span<const KeyFrameId> along = {});

/// Writes solved poses and points into the atlas and unlinks observations judged outliers.
void apply_bundle(Atlas& atlas, const GatheredBundle& gathered, const BundleResult& result);

}  // namespace ydd
