// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "bench/bench_seeds.h"
#include "ydd/base/log.h"
#include "ydd/studies/accidents.h"

namespace ydd::app {

using Json = nlohmann::ordered_json;

Result<std::string> bench_recovery(const SeedRequest& request) {
  Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  options->deterministic = true;
  const std::optional<Senses> senses = parse_choice<Senses>(request.senses);
  std::string table =
      "| accident | runs | found again | frames until then, median (worst) | false places | maps "
      "merged | frames with a pose | ATE m, median (worst) |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  for (const Accident& accident : accidents()) {
    if (!is_wanted(request, accident.name)) continue;
    int found = 0, wrong = 0, merged = 0;
    std::vector<double> frames, ate_m, with_pose;
    for (int i = 0; i < request.seeds; ++i) {
      const int seed = request.first_seed + i;
      const Result<AccidentOutcome> suffered =
          suffer(accident, walk_world(request, seed), *options, *senses);
      if (!suffered) return suffered.error();
      const AccidentOutcome& outcome = *suffered;
      log::info("{}, seed {}: {}", accident.name, seed,
                outcome.frames ? fmt::format("found after {} frames", *outcome.frames)
                               : std::string("not found"));
      found += outcome.frames ? 1 : 0;
      wrong += outcome.wrong ? 1 : 0;
      merged += outcome.merged ? 1 : 0;
      if (outcome.frames) frames.push_back(*outcome.frames);
      ate_m.push_back(outcome.ate_m);
      with_pose.push_back(outcome.with_pose_share);
    }
    const SeriesStatistics f = statistics_of(frames), a = statistics_of(ate_m);
    table += fmt::format(
        "| {} | {} | {} | {:.0f} ({:.0f}) | {} | {} | {:.1f} % | "
        "{:.4f} ({:.4f}) |\n",
        accident.name, request.seeds, found, f.median, f.max, wrong, merged,
        100 * statistics_of(with_pose).median, a.median, a.max);
    json.push_back({{"accident", accident.name},
                    {"runs", request.seeds},
                    {"found", found},
                    {"frames", frames},
                    {"false_places", wrong},
                    {"merged", merged},
                    {"frames_with_pose", with_pose},
                    {"ate_rmse_m", ate_m}});
  }
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
