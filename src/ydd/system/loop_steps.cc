// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/loop_steps.h"

#include <utility>

#include "ydd/base/log.h"
#include "ydd/mapping/apply_correction.h"

namespace ydd::loop_steps {
namespace {

LoopReport describe(const Atlas& atlas, const LoopMatch& match) {
  const KeyFrame& current = atlas.at(match.current);
  const KeyFrame& matched = atlas.at(match.matched);
  const SE3 drift = current.T_world_camera.inverse() * match.T_world_current;
  return {match.current,
          match.matched,
          current.frame_index,
          matched.frame_index,
          static_cast<int>(match.seen.size()),
          drift.translation().norm(),
          current.map != matched.map,
          matched.T_world_camera.inverse() * match.T_world_current};
}

}  // namespace

std::optional<LoopMatch> find(const Atlas& atlas, KeyFrameId id, const LoopOptions& options,
                              MappingReports& reports) {
  StageTimer timer(reports.loop_times, "find_loop");
  return find_loop(atlas, id, options);
}

std::optional<Correction> correct(const Atlas& atlas, const LoopMatch& match,
                                  const LoopOptions& options, MappingReports& reports,
                                  const std::stop_token& stop) {
  StageTimer timer(reports.loop_times, "correct_loop");
  auto correction = correct_loop(atlas, match, options, stop);
  if (!correction) ++reports.loop_counts.interrupted;
  return correction;
}

void prepare(std::shared_ptr<const Atlas> atlas, Correction& correction, MappingReports& reports) {
  StageTimer timer(reports.loop_times, "prepare_correction");
  prepare_correction(std::move(atlas), correction);
}

void report(const Atlas& before, const LoopMatch& match, MappingReports& reports) {
  reports.loops.push_back(describe(before, match));
  const LoopReport& loop = reports.loops.back();
  log::info("frame {}: {} with frame {} ({} points, {:.3f} m)", loop.current_frame,
            loop.merged ? "map merged" : "loop closed", loop.matched_frame, loop.inliers,
            loop.shift_m);
}

std::optional<Correction> refine(const Atlas& atlas, KeyFrameId member, const LoopOptions& options,
                                 MappingReports& reports, const std::stop_token& stop) {
  StageTimer timer(reports.loop_times, "full_bundle");
  return full_bundle(atlas, member, options, stop);
}

bool count(Applied applied, MappingReports& reports) {
  if (applied == Applied::rebased) ++reports.loop_counts.rebased;
  if (applied != Applied::refused) return true;
  ++reports.loop_counts.refused;
  log::warning("a correction of the map came too late: another one had moved it");
  return false;
}

}  // namespace ydd::loop_steps
