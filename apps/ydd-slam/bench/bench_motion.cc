// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench_seeds.h"
#include "bench/figures.h"
#include "ydd/studies/found_motion.h"
#include "ydd/system/system_options.h"

namespace ydd::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kSpeeds_m_s = {0.05, 0.1, 0.2, 0.5, 1.0, 1.5};
constexpr std::array kDistances_m = {1.0, 1.8, 2.5, 3.5};

/// Frames to find a mover in each of so many worlds, in order; where it was not found, as long as
/// the sequence.
std::vector<int> frames_to_find(const MoverOptions& mover, const EvidenceOptions& options,
                                const SeedRequest& request) {
  std::vector<int> frames;
  for (int i = 0; i < request.seeds; ++i) {
    const auto seed = static_cast<std::uint32_t>(request.first_seed + i);
    const int found = find_motion(mover, options, seed).frames_to_find;
    frames.push_back(found < 0 ? mover.frames : found);
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

}  // namespace

Result<std::string> bench_motion(const SeedRequest& request) {
  const Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  const EvidenceOptions& evidence = options->dynamics.evidence;
  Json json;
  std::string table = "| speed, m/s |";
  for (const double distance_m : kDistances_m) table += fmt::format(" at {} m |", distance_m);
  table += "\n| --- | --- | --- | --- | --- |\n";
  for (const double speed_m_s : kSpeeds_m_s) {
    table += fmt::format("| {} |", speed_m_s);
    for (const double distance_m : kDistances_m) {
      MoverOptions mover;
      mover.speed_m_s = speed_m_s;
      mover.distance_m = distance_m;
      const std::vector<int> frames = frames_to_find(mover, evidence, request);
      table += fmt::format(" {} ({}) |", frames[frames.size() / 2], frames.back());
      json["frames_to_find"].push_back(
          {{"speed_m_s", speed_m_s}, {"distance_m", distance_m}, {"frames", frames}});
    }
    table += "\n";
  }
  MoverOptions still;
  still.speed_m_s = 0;
  double seconds = 0, false_share = 0;
  int alarms = 0;
  for (int i = 0; i < request.seeds; ++i) {
    const FoundMotion found =
        find_motion(still, evidence, static_cast<std::uint32_t>(request.first_seed + i));
    seconds += found.seconds;
    alarms += found.false_alarms;
    false_share += found.false_share / request.seeds;
  }
  json["rigid"] = {{"seconds", seconds}, {"false_alarms", alarms}, {"false_share", false_share}};
  table += fmt::format(
      "\nFrames until half of a mover of {} m is judged to move: median (largest) of {} worlds; "
      "{}: "
      "not found.\nNothing moves: {} false alarms in {:.0f} s, {:.4f} % of the cells.\n",
      still.side_m, request.seeds, still.frames, alarms, seconds, 100 * false_share);
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
