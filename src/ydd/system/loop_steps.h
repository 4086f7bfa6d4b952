// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stop_token>

#include "ydd/system/mapping_runner.h"

/// What the loop closer does with a keyframe, timed and told: the same steps in any thread.
namespace ydd::loop_steps {

std::optional<LoopMatch> find(const Atlas& atlas, KeyFrameId id, const LoopOptions& options,
                              MappingReports& reports);

/// Nothing if interrupted.
std::optional<Correction> correct(const Atlas& atlas, const LoopMatch& match,
                                  const LoopOptions& options, MappingReports& reports,
                                  const std::stop_token& stop);
/// Does what can be done of applying it, so that the mapper need not (prepare_correction).
void prepare(std::shared_ptr<const Atlas> atlas, Correction& correction, MappingReports& reports);

/// Tells that a loop has been closed.
void report(const Atlas& before, const LoopMatch& match, MappingReports& reports);

/// Nothing if the map is gone, or if it was interrupted before anything became better.
std::optional<Correction> refine(const Atlas& atlas, KeyFrameId member, const LoopOptions& options,
                                 MappingReports& reports, const std::stop_token& stop);

/// Counts what became of a correction. False when it was refused.
bool count(Applied applied, MappingReports& reports);

}  // namespace ydd::loop_steps
