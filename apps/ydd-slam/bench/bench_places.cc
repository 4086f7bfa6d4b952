// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "bench/bench_seeds.h"
#include "common/scratch_folder.h"
#include "run/run_job.h"
#include "ydd/base/interruption.h"
#include "ydd/base/log.h"
#include "ydd/studies/place_recall.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Two rounds of a walk, mapped without closing loops.
Result<void> add_walk(const SeedRequest& request, int seed, bool look_alike, PlaceCounts& counts) {
  WorldOptions world = walk_world(request, seed, look_alike ? 2 : 1);
  world.repeated_posters = world.identical_desks = look_alike;
  world.frames =
      static_cast<int>((look_alike ? 1.6 : 2.0) * make_camera_path(world).round_s * request.fps);
  Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  options->deterministic = true;
  options->loop.enabled = false;
  const Simulator simulator(world);
  const Result<SimulatedRun> run = run_simulated(simulator, *options);
  if (!run) return run.error();
  std::vector<Place> places;
  run->atlas->keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    places.push_back({id, simulator.pose(static_cast<int>(keyframe.frame_index))});
  });
  count_places(*run->atlas, places, LoopOptions(), counts, request.apart_s);
  log::info("seed {}: {} keyframes, {} revisits so far", seed, places.size(), counts.queries);
  return {};
}

std::string row(const std::string& name, const PlaceCounts& c) {
  return fmt::format("| {} | {} | {} | {:.1f} % | {:.1f} % | {:.1f} % | {} |\n", name, c.queries,
                     c.strangers, 100 * c.top1_recall(), 100 * c.recall_at_full_precision(),
                     100 * c.share(c.verified_right), c.verified_wrong);
}

Json to_json(const std::string& name, const PlaceCounts& c) {
  return {{"world", name},
          {"revisits", c.queries},
          {"strangers", c.strangers},
          {"top1_recall", c.top1_recall()},
          {"recall_at_full_precision", c.recall_at_full_precision()},
          {"verified_recall", c.share(c.verified_right)},
          {"verified_wrong", c.verified_wrong}};
}

/// A recording with ground truth, mapped without closing loops.
Result<PlaceCounts> recording_counts(const std::string& sequence, const SeedRequest& request) {
  RunRequest run;
  run.sequence = sequence;
  run.set = request.set;
  run.set.emplace_back("loop.enabled=false");
  run.deterministic = run.quiet = true;
  const Result<ScratchFolder> scratch = ScratchFolder::make();
  if (!scratch) return scratch.error();
  run.out = (scratch->path() / "run").string();
  const Result<RunOutcome> outcome = run_whole_sequence(run);
  interruption::throw_if_asked();
  if (!outcome) return outcome.error();
  if (!outcome->groundtruth_file) {
    return Error{fmt::format("{}: has no groundtruth.txt", sequence)};
  }
  const Result<StampedPoses> truth = read_tum_trajectory(*outcome->groundtruth_file);
  if (!truth) return truth.error();
  std::vector<Place> places;
  outcome->atlas->keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    const auto next = std::lower_bound(
        truth->begin(), truth->end(), keyframe.stamp,
        [](const StampedPose& pose, Timestamp stamp) { return pose.stamp < stamp; });
    if (next != truth->end()) places.push_back({id, next->T_world_camera});
  });
  PlaceCounts counts;
  count_places(*outcome->atlas, places, LoopOptions(), counts, request.apart_s);
  return counts;
}

}  // namespace

Result<std::string> bench_places(const SeedRequest& request) {
  std::string table =
      "| world | revisits | other keyframes | best candidate is the place | the same at 100 % "
      "precision | verified | verified but wrong |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  for (const bool look_alike : {false, true}) {
    const std::string name = look_alike ? "simulated, look-alike rooms" : "simulated room";
    if (request.seeds == 0 || !is_wanted(request, name)) continue;
    PlaceCounts counts;
    for (int i = 0; i < request.seeds; ++i) {
      if (auto r = add_walk(request, request.first_seed + i, look_alike, counts); !r) {
        return r.error();
      }
    }
    table += row(name, counts);
    json.push_back(to_json(name, counts));
  }
  for (const std::string& sequence : request.sequences) {
    const Result<PlaceCounts> counts = recording_counts(sequence, request);
    if (!counts) return counts.error();
    const std::string name = fs::weakly_canonical(sequence).filename().string();
    table += row(name, *counts);
    json.push_back(to_json(name, *counts));
  }
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
