// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench_seeds.h"
#include "bench/figures.h"
#include "ydd/base/timing.h"
#include "ydd/studies/track_errors.h"
#include "ydd/system/system_options.h"

namespace ydd::app {
namespace {

using Json = nlohmann::ordered_json;

/// A world with people in it.
struct PeopleWorld {
  const char* name;
  bool busy;
  PathKind path;
};
constexpr std::array<PeopleWorld, 4> kPeopleWorlds = {{
    {"busy, camera stands", true, PathKind::stationary},
    {"busy, camera moves", true, PathKind::xyz},
    {"four people, camera moves", false, PathKind::halfsphere},
    {"four people, walk through the room", false, PathKind::room_loop},
}};

WorldOptions options_of(const PeopleWorld& kind, const SeedRequest& request, int seed) {
  WorldOptions world = walk_world(request, seed);
  world.path = kind.path;
  world.busy = kind.busy;
  if (!kind.busy) world.people = 4;
  world.frames = static_cast<int>(10 * request.fps);
  return world;
}

Json json_of(const TrackErrors& e) {
  return {{"wanted", e.wanted},
          {"found", e.found},
          {"told", e.told},
          {"false", e.false_ones},
          {"switches", e.switches},
          {"within_95", e.within},
          {"across_m",
           {{"median", statistics_of(e.across_m).median}, {"p95", statistics_of(e.across_m).p95}}},
          {"height_m",
           {{"median", statistics_of(e.height_m).median}, {"p95", statistics_of(e.height_m).p95}}},
          {"velocity_m_s",
           {{"median", statistics_of(e.velocity_m_s).median},
            {"p95", statistics_of(e.velocity_m_s).p95}}}};
}

std::string row_of(const char* name, const TrackErrors& e) {
  const auto percent = [](int part, std::size_t whole) {
    return whole == 0 ? 0.0 : 100.0 * part / static_cast<double>(whole);
  };
  const SeriesStatistics across = statistics_of(e.across_m), height = statistics_of(e.height_m),
                         speed = statistics_of(e.velocity_m_s);
  return fmt::format(
      "| {} | {:.1f} % | {:.1f} % | {} | {:.3f} ({:.3f}) | {:.3f} ({:.3f}) | {:.2f} ({:.2f}) | "
      "{:.0f} % |\n",
      name, percent(e.found, static_cast<std::size_t>(e.wanted)),
      percent(e.false_ones, static_cast<std::size_t>(e.told)), e.switches, across.median,
      across.p95, height.median, height.p95, speed.median, speed.p95,
      percent(e.within, e.across_m.size()));
}

}  // namespace

Result<std::string> bench_tracks(const SeedRequest& request) {
  const Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  Json json;
  std::string table =
      "| world | people found | tracks of nobody | switches | across, m | height, m | velocity, "
      "m/s | in 95 % ellipse |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const PeopleWorld& kind : kPeopleWorlds) {
    if (!is_wanted(request, kind.name)) continue;
    TrackErrors all;
    for (int i = 0; i < request.seeds; ++i) {
      const Simulator simulator(options_of(kind, request, request.first_seed + i));
      const Result<SimulatedRun> run = run_simulated(simulator, *options);
      if (!run) return run.error();
      all.add(track_errors(*run, simulator));
    }
    json[kind.name] = json_of(all);
    table += row_of(kind.name, all);
  }
  table += fmt::format(
      "\nExact boxes, depth as of a Kinect, {} px, {} Hz, {} worlds each. Errors: median (95 %) of "
      "the tracks told in all frames, those included that coast.\n",
      request.width_px, request.fps, request.seeds);
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
