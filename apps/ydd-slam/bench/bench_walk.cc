// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/bench_seeds.h"
#include "ydd/base/log.h"

namespace ydd::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kRooms = 4;
constexpr double kReport_s = 30.0;

/// Resident size of this process now, megabytes.
double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

/// What happened in one stretch of the walk.
struct Stretch {
  double time_s = 0;
  std::vector<double> cpu_ms;
  double memory_mb = 0;
  std::size_t keyframes = 0, points = 0;
  int lost = 0;
};

std::string row(const Stretch& s) {
  const SeriesStatistics cpu = statistics_of(s.cpu_ms);
  return fmt::format("| {:.1f} | {:.2f} | {:.2f} | {:.0f} | {} | {} | {} |\n", s.time_s / 60.0,
                     cpu.median, cpu.p95, s.memory_mb, s.keyframes, s.points, s.lost);
}

Json to_json(const Stretch& s) {
  const SeriesStatistics cpu = statistics_of(s.cpu_ms);
  return {{"time_s", s.time_s},          {"frame_cpu_ms_median", cpu.median},
          {"frame_cpu_ms_p95", cpu.p95}, {"resident_mb", s.memory_mb},
          {"keyframes", s.keyframes},    {"points", s.points},
          {"lost_frames", s.lost}};
}

}  // namespace

Result<std::string> bench_walk(const SeedRequest& request) {
  WorldOptions world = walk_world(request, request.first_seed, kRooms);
  world.frames = static_cast<int>(request.minutes * 60.0 * request.fps);
  const Simulator simulator(world);
  Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  const int stride = static_cast<int>(kReport_s * request.fps);
  std::vector<Stretch> stretches(1);
  const auto done = [&](int index, const SimulatedStep& step) {
    Stretch& s = stretches.back();
    s.cpu_ms.push_back(step.cpu_ms);
    if (step.state == TrackingState::lost) ++s.lost;
    if ((index + 1) % stride != 0) return;
    s.time_s = (index + 1) / request.fps;
    s.memory_mb = resident_mb();
    s.keyframes = step.keyframes;
    s.points = step.points;
    log::info("{:.1f} min: {} keyframes, {} points, {:.0f} MB", s.time_s / 60.0, s.keyframes,
              s.points, s.memory_mb);
    stretches.emplace_back();
  };
  const Result<SimulatedRun> run = run_simulated(simulator, *options, {}, done);
  if (!run) return run.error();
  stretches.pop_back();
  std::string table =
      "| minute | ms CPU a frame, median | p95 | resident MB | keyframes | points | lost frames |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  Json series = Json::array();
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    series.push_back(to_json(stretches[i]));
    if (i % 10 == 1 || i + 1 == stretches.size()) table += row(stretches[i]);
  }
  int wrong = 0;
  for (const CheckedLoop& loop : run->loops) wrong += loop.is_false() ? 1 : 0;
  table +=
      fmt::format("\n{:.0f} minutes through {} rooms: ATE {:.4f} m, {} loops, {} of them false\n",
                  request.minutes, kRooms, run->ate_m(), run->loops.size(), wrong);
  const Json json = {{"minutes", request.minutes},
                     {"rooms", kRooms},
                     {"fps", request.fps},
                     {"ate_rmse_m", run->ate_m()},
                     {"loops", run->loops.size()},
                     {"false_loops", wrong},
                     {"series", series}};
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
