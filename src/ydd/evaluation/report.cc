// SPDX-License-Identifier: Apache-2.0
#include "ydd/evaluation/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ydd/base/json_text.h"

namespace ydd {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const ErrorStatistics& s) {
  if (s.count == 0) return nullptr;
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
          {"std", s.sd},    {"min", s.min},   {"max", s.max}};
}

const char* alignment_name(const EvaluationOptions& options) {
  return options.ate.scale == AlignmentScale::fixed ? "SE(3)" : "Sim(3)";
}

const char* unit_name(RpeUnit unit) { return unit == RpeUnit::seconds ? "s" : "frames"; }

std::string table_line(const std::string& name, const ErrorStatistics& s) {
  if (s.count == 0) return fmt::format("{:<20}no pair that far apart\n", name);
  return fmt::format("{:<20}{:>10.6f}{:>10.6f}{:>10.6f}{:>10.6f}{:>10.6f}{:>10.6f}{:>8}\n", name,
                     s.rmse, s.mean, s.median, s.sd, s.min, s.max, s.count);
}

}  // namespace

Result<Evaluation> evaluate(const StampedPoses& groundtruth, const StampedPoses& estimate,
                            const EvaluationOptions& options) {
  Result<AteResult> ate = absolute_trajectory_error(groundtruth, estimate, options.ate);
  if (!ate) return ate.error();
  Evaluation evaluation;
  evaluation.options = options;
  evaluation.poses = estimate.size();
  evaluation.ate = *std::move(ate);
  evaluation.options.rpe.scale = evaluation.ate.alignment.scale;
  evaluation.rpe = relative_pose_error(groundtruth, estimate, evaluation.options.rpe);
  return evaluation;
}

std::string format_table(const Evaluation& e) {
  const std::string rpe =
      fmt::format("RPE/{} {}", e.options.rpe.delta, unit_name(e.options.rpe.unit));
  std::string text =
      fmt::format("{} of {} poses with ground truth within {} s; aligned by {}", e.ate.pairs.size(),
                  e.poses, e.options.ate.max_difference_s, alignment_name(e.options));
  if (e.options.ate.scale == AlignmentScale::estimated) {
    text += fmt::format(", scale {:.6f}", e.ate.alignment.scale);
  }
  text += fmt::format("\n{:<20}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>8}\n", "", "RMSE", "mean",
                      "median", "S.D.", "min", "max", "pairs");
  text += table_line("ATE [m]", e.ate.statistics_m);
  text += table_line(rpe + " [m]", e.rpe.translation_m);
  text += table_line(rpe + " [deg]", e.rpe.rotation_deg);
  return text;
}

std::string format_json(const Evaluation& e) {
  Json json;
  json["poses"] = e.poses;
  json["ate"] = {{"pairs", e.ate.pairs.size()},
                 {"max_difference_s", e.options.ate.max_difference_s},
                 {"alignment", alignment_name(e.options)},
                 {"scale", e.ate.alignment.scale},
                 {"absolute_translational_error", to_json(e.ate.statistics_m)}};
  json["rpe"] = {{"pairs", e.rpe.translation_m.count},
                 {"delta", e.options.rpe.delta},
                 {"unit", unit_name(e.options.rpe.unit)},
                 {"translational_error", to_json(e.rpe.translation_m)},
                 {"rotational_error", to_json(e.rpe.rotation_deg)}};
  return json_text(json, 1) + "\n";
}

}  // namespace ydd
