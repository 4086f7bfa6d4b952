// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_scale.h"

#include <malloc.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <functional>

#include <fmt/format.h>

#include "bench/bench_seeds.h"
#include "common/scratch_folder.h"
#include "ydd/base/log.h"
#include "ydd/studies/map_costs.h"

namespace ydd::app {
namespace {

using Json = nlohmann::ordered_json;

/// Resident size of this process now, megabytes.
double resident_now_mb() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

struct SizedCosts {
  MapCosts costs;
  double memory_mb = 0;  ///< of the map: what the process holds more than before
};

/// A row of the table: what it is called, and its figure for one size.
struct CostRow {
  std::string name, key;
  std::function<double(const SizedCosts&)> value;
  bool fitted = true;
};

double median_of(const std::vector<double>& values) { return statistics_of(values).median; }

std::vector<CostRow> cost_rows() {
  return {
      {"place query, median ms", "query_ms",
       [](const SizedCosts& s) { return median_of(s.costs.query_ms); }},
      {"place query, 99th percentile ms", "query_p99_ms",
       [](const SizedCosts& s) { return statistics_of(s.costs.query_ms).p99; }},
      {"places recognised, %", "recognised_percent",
       [](const SizedCosts& s) {
         return 100.0 * s.costs.recognised / static_cast<double>(s.costs.query_ms.size());
       },
       false},
      {"local map, median ms", "gather_ms",
       [](const SizedCosts& s) { return median_of(s.costs.gather_ms); }},
      {"tracking a frame, median ms", "track_ms",
       [](const SizedCosts& s) { return median_of(s.costs.track_ms); }},
      {"tracking a frame, 99th percentile ms", "track_p99_ms",
       [](const SizedCosts& s) { return statistics_of(s.costs.track_ms).p99; }},
      {"a lost frame, median ms", "relocalise_ms",
       [](const SizedCosts& s) { return median_of(s.costs.relocalise_ms); }},
      {"keyframe inserted, median ms", "insert_ms",
       [](const SizedCosts& s) { return median_of(s.costs.insert_ms); }},
      {"map published, median ms", "publish_ms",
       [](const SizedCosts& s) { return median_of(s.costs.publish_ms); }},
      {"keyframe looked at for a loop, median ms", "look_ms",
       [](const SizedCosts& s) { return median_of(s.costs.look_ms); }},
      {"loop: pose graph, ms", "correct_ms",
       [](const SizedCosts& s) { return s.costs.correct_ms; }},
      {"loop: prepared beside the mapper, ms", "prepare_ms",
       [](const SizedCosts& s) { return s.costs.prepare_ms; }},
      {"loop: applied, ms", "apply_ms", [](const SizedCosts& s) { return s.costs.apply_ms; }},
      {"first save, CPU ms", "save_whole_ms",
       [](const SizedCosts& s) { return s.costs.save_whole_ms; }},
      {"first save, MB written", "save_whole_mb",
       [](const SizedCosts& s) { return static_cast<double>(s.costs.save_whole_bytes) * 1e-6; }},
      {"save of what is new, CPU ms", "save_new_ms",
       [](const SizedCosts& s) { return s.costs.save_new_ms; }},
      {"save of what is new, MB written", "save_new_mb",
       [](const SizedCosts& s) { return static_cast<double>(s.costs.save_new_bytes) * 1e-6; }},
      {"save of what is new, rows", "save_new_rows",
       [](const SizedCosts& s) { return static_cast<double>(s.costs.save_new_rows); }},
      {"load, CPU ms", "load_ms", [](const SizedCosts& s) { return s.costs.load_ms; }},
      {"memory of the map, MB", "memory_mb", [](const SizedCosts& s) { return s.memory_mb; }},
      {"opened in part, CPU ms", "open_ms", [](const SizedCosts& s) { return s.costs.open_ms; }},
      {"memory of it then, MB", "opened_mb", [](const SizedCosts& s) { return s.costs.opened_mb; }},
      {"memory of it after walks, MB", "walked_mb",
       [](const SizedCosts& s) { return s.costs.walked_mb; }},
      {"place found and loaded from the file, median ms", "place_ms",
       [](const SizedCosts& s) { return median_of(s.costs.place_ms); }},
  };
}

/// The rooms that buildings are grown from, mapped by the system itself.
Result<std::vector<std::shared_ptr<const Atlas>>> mapped_rooms(const ScaleRequest& request,
                                                               SystemOptions options) {
  options.deterministic = true;
  options.map.pictures = false;
  options.dynamics.variant = Variant::off;  // nobody is there
  options.dynamics.compensation.points = request.keypoints;
  std::vector<std::shared_ptr<const Atlas>> rooms;
  for (int i = 0; i < request.rooms; ++i) {
    SeedRequest walk;
    walk.width_px = request.width_px;
    walk.fps = request.fps;
    const Simulator simulator(walk_world(walk, request.first_seed + i));
    const Result<SimulatedRun> run = run_simulated(simulator, options);
    if (!run) return run.error();
    log::info("room {} of {}: {} keyframes, {} points", i + 1, request.rooms,
              run->atlas->keyframes().size(), run->atlas->points().size());
    rooms.push_back(run->atlas);
  }
  return rooms;
}

Result<SizedCosts> measure_size(const std::vector<std::shared_ptr<const Atlas>>& rooms,
                                std::size_t keyframes, const ScaleRequest& request,
                                const SystemOptions& options) {
  const Result<ScratchFolder> scratch = ScratchFolder::make();
  if (!scratch) return scratch.error();
  ::malloc_trim(0);
  const double before_mb = resident_now_mb();
  BuildingOptions building_options;
  building_options.keyframes = keyframes;
  building_options.seed = request.seed;
  Building building = grow_building(rooms, building_options);
  ::malloc_trim(0);
  SizedCosts sized;
  sized.memory_mb = resident_now_mb() - before_mb;
  log::info("{} keyframes, {} points, {:.0f} MB", building.atlas.keyframes().size(),
            building.atlas.points().size(), sized.memory_mb);
  Result<MapCosts> costs =
      measure_map(std::move(building), options, scratch->path() / "scale.map", [] {
        ::malloc_trim(0);
        return resident_now_mb();
      });
  if (!costs) return costs.error();
  sized.costs = std::move(*costs);
  return sized;
}

std::string number(double value) {
  return value >= 100 ? fmt::format("{:.0f}", value)
                      : fmt::format("{:.{}f}", value, value >= 1 ? 2 : 3);
}

std::string table_of(const std::vector<SizedCosts>& all, Json& exponents) {
  std::string head = "| keyframes |", rule = "| --- |", points = "| points |";
  std::vector<double> sizes;
  for (const SizedCosts& s : all) {
    head += fmt::format(" {} |", s.costs.keyframes);
    points += fmt::format(" {} |", s.costs.points);
    rule += " --- |";
    sizes.push_back(static_cast<double>(s.costs.keyframes));
  }
  std::string table = head + " grows with the power |\n" + rule + " --- |\n" + points + " |\n";
  for (const CostRow& row : cost_rows()) {
    std::vector<double> values;
    table += fmt::format("| {} |", row.name);
    for (const SizedCosts& s : all) {
      values.push_back(row.value(s));
      table += fmt::format(" {} |", number(values.back()));
    }
    const double exponent = fitted_exponent(sizes, values);
    const bool known = row.fitted && std::isfinite(exponent);
    if (known) exponents[row.key] = exponent;
    table += known ? fmt::format(" {:.2f} |\n", exponent) : " |\n";
  }
  return table;
}

Json json_of(const SizedCosts& s) {
  Json json = {{"keyframes", s.costs.keyframes},
               {"points", s.costs.points},
               {"new_keyframes", s.costs.new_keyframes},
               {"lost_frames", s.costs.lost_frames},
               {"lost_in_part", s.costs.lost_in_part}};
  for (const CostRow& row : cost_rows()) json[row.key] = row.value(s);
  return json;
}

}  // namespace

Result<std::string> bench_scale(const ScaleRequest& request) {
  const Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  const auto rooms = mapped_rooms(request, *options);
  if (!rooms) return rooms.error();
  std::vector<SizedCosts> all;
  Json series = Json::array();
  for (const std::size_t keyframes : request.sizes) {
    Result<SizedCosts> sized = measure_size(*rooms, keyframes, request, *options);
    if (!sized) return sized.error();
    series.push_back(json_of(*sized));
    all.push_back(std::move(*sized));
  }
  Json exponents = Json::object();
  std::string table = table_of(all, exponents);
  const Json json = {{"keypoints", request.keypoints},
                     {"width_px", request.width_px},
                     {"seed", request.seed},
                     {"exponents", exponents},
                     {"series", series}};
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
