// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "bench/bench_seeds.h"
#include "ydd/base/log.h"

namespace ydd::app {
namespace {

using Json = nlohmann::ordered_json;

struct World {
  const char* name;
  int rooms;
  bool look_alike;
};

constexpr World kWorlds[] = {{"one room", 1, false},
                             {"two rooms", 2, false},
                             {"three rooms, same posters and desks", 3, true}};

/// Figures of one world over its seeds.
struct LoopFigures {
  int closed = 0, wrong = 0, runs_with_loop = 0, lost_frames = 0, runs = 0;
  std::vector<double> ate_with_m, ate_without_m, error_m, error_deg;
};

Result<void> add_seed(const World& world, int seed, const SeedRequest& request, LoopFigures& out) {
  WorldOptions options = walk_world(request, seed, world.rooms);
  options.repeated_posters = options.identical_desks = world.look_alike;
  const Simulator simulator(options);
  const FrameStore frames(simulator);
  Result<SystemOptions> system = system_options(request.set);
  if (!system) return system.error();
  system->deterministic = true;
  const Result<SimulatedRun> with = frames.run(*system);
  if (!with) return with.error();
  system->loop.enabled = false;
  const Result<SimulatedRun> without = frames.run(*system);
  if (!without) return without.error();
  for (const CheckedLoop& loop : with->loops) {
    ++out.closed;
    if (loop.is_false()) ++out.wrong;
    out.error_m.push_back(loop.error_m);
    out.error_deg.push_back(loop.error_rad * 57.29577951308232);
    log::info("{}, seed {}: frame {} with {}: {} points, off by {:.3f} m", world.name, seed,
              loop.report.current_frame, loop.report.matched_frame, loop.report.inliers,
              loop.error_m);
  }
  ++out.runs;
  if (!with->loops.empty()) ++out.runs_with_loop;
  out.lost_frames += with->lost_frames();
  out.ate_with_m.push_back(with->ate_m());
  out.ate_without_m.push_back(without->ate_m());
  return {};
}

Json to_json(const World& world, const LoopFigures& f) {
  return {{"world", world.name},
          {"runs", f.runs},
          {"runs_with_loop", f.runs_with_loop},
          {"loops", f.closed},
          {"false_loops", f.wrong},
          {"lost_frames", f.lost_frames},
          {"ate_rmse_m_with", f.ate_with_m},
          {"ate_rmse_m_without", f.ate_without_m},
          {"loop_error_m", f.error_m},
          {"loop_error_deg", f.error_deg}};
}

}  // namespace

Result<std::string> bench_loops(const SeedRequest& request) {
  std::string table =
      "| world | seeds | runs with a loop | loops | false | loop error m, median (worst) | ATE m "
      "without, median | ATE m with, median (worst) | lost frames |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  for (const World& world : kWorlds) {
    if (!is_wanted(request, world.name)) continue;
    LoopFigures f;
    for (int i = 0; i < request.seeds; ++i) {
      if (auto r = add_seed(world, request.first_seed + i, request, f); !r) return r.error();
    }
    const SeriesStatistics error = statistics_of(f.error_m), with = statistics_of(f.ate_with_m);
    table += fmt::format(
        "| {} | {} | {} | {} | {} | {:.3f} ({:.3f}) | {:.4f} | {:.4f} ({:.4f}) | {} |\n",
        world.name, f.runs, f.runs_with_loop, f.closed, f.wrong, error.median, error.max,
        statistics_of(f.ate_without_m).median, with.median, with.max, f.lost_frames);
    json.push_back(to_json(world, f));
  }
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
