// SPDX-License-Identifier: Apache-2.0
#include "ydd/paper/run_figures.h"

#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ydd/base/json_reader.h"
#include "ydd/base/json_text.h"
#include "ydd/base/one_line.h"
#include "ydd/evaluation/ate.h"
#include "ydd/evaluation/rpe.h"

namespace ydd {
namespace {

using RunJson = nlohmann::ordered_json;

void add_statistics(const std::string& quantity, const ErrorStatistics& s, RunFigures& run) {
  if (s.count == 0) return;
  run.values[quantity + ".rmse"] = s.rmse;
  run.values[quantity + ".mean"] = s.mean;
  run.values[quantity + ".median"] = s.median;
  run.values[quantity + ".sd"] = s.sd;
}

/// Degrees as the Frobenius norm of R - I.
std::vector<double> unitless(std::span<const double> rotations_deg) {
  std::vector<double> out;
  out.reserve(rotations_deg.size());
  for (const double deg : rotations_deg) {
    out.push_back(2 * std::numbers::sqrt2 * std::sin(deg * std::numbers::pi / 360));
  }
  return out;
}

/// Tenths of a millimetre, a tenth of a millisecond: more than a plot shows.
double short_number(double value) { return std::round(value * 1e4) / 1e4; }

RunJson list_of(std::span<const double> values) {
  RunJson out = RunJson::array();
  for (const double value : values) out.push_back(short_number(value));
  return out;
}

RunJson list_of(std::span<const Eigen::Vector3d> points) {
  RunJson out = RunJson::array();
  for (const Eigen::Vector3d& p : points) {
    out.push_back({short_number(p.x()), short_number(p.y()), short_number(p.z())});
  }
  return out;
}

double number_of(const RunJson& json) {
  const auto value = json.get<double>();
  if (!std::isfinite(value)) throw std::invalid_argument("a number that is none");
  return value;
}

std::vector<double> numbers_of(const RunJson& json) {
  if (!json.is_array()) throw std::invalid_argument("a list is expected");
  std::vector<double> out;
  for (const RunJson& value : json) out.push_back(number_of(value));
  return out;
}

std::vector<Eigen::Vector3d> points_of(const RunJson& json) {
  if (!json.is_array()) throw std::invalid_argument("a list of points is expected");
  std::vector<Eigen::Vector3d> out;
  for (const RunJson& point : json) {
    const std::vector<double> p = numbers_of(point);
    if (p.size() != 3) throw std::invalid_argument("a point must be three numbers");
    out.emplace_back(p[0], p[1], p[2]);
  }
  return out;
}

RunFigures run_of(const RunJson& json) {
  RunFigures run;
  run.settings = json.at("settings").get<std::string>();
  run.sequence = json.at("sequence").get<std::string>();
  run.variant = json.at("variant").get<std::string>();
  if (!json.at("run").is_number_integer()) throw std::invalid_argument("'run' must be a number");
  run.run = json.at("run").get<int>();
  const RunJson& values = json.at("values");
  if (!values.is_object()) throw std::invalid_argument("'values' must be an object");
  for (const auto& [key, value] : values.items()) run.values[key] = number_of(value);
  RunCurves& curves = run.curves;
  curves.truth_m = points_of(json.at("truth_m"));
  curves.estimate_m = points_of(json.at("estimate_m"));
  curves.rpe_stamp_s = numbers_of(json.at("rpe_stamp_s"));
  curves.rpe_m = numbers_of(json.at("rpe_m"));
  curves.requested = numbers_of(json.at("requested"));
  // A trajectory without truth is an estimate alone.
  const bool paired = curves.truth_m.empty() || curves.truth_m.size() == curves.estimate_m.size();
  if (!paired || curves.rpe_m.size() != curves.rpe_stamp_s.size()) {
    throw std::invalid_argument("lists of different lengths");
  }
  return run;
}

}  // namespace

void score_trajectory(const StampedPoses& truth, const StampedPoses& trajectory, RunFigures& run) {
  const Result<AteResult> ate = absolute_trajectory_error(truth, trajectory);
  if (!ate) return;
  add_statistics("ate_m", ate->statistics_m, run);
  for (const IndexPair& pair : ate->pairs) {
    run.curves.truth_m.push_back(truth[pair.a].T_world_camera.translation());
    run.curves.estimate_m.push_back(ate->alignment *
                                    trajectory[pair.b].T_world_camera.translation());
  }
  RpeOptions per_frame;
  per_frame.delta = 1;
  per_frame.unit = RpeUnit::frames;
  const RpeResult rpe = relative_pose_error(truth, trajectory, per_frame);
  add_statistics("rpe_m", rpe.translation_m, run);
  add_statistics("rpe_rotation", error_statistics(unitless(rpe.rotation_errors_deg)), run);
  run.curves.rpe_m = rpe.translation_errors_m;
  for (const std::size_t pose : rpe.first_poses) {
    const auto since_ns = trajectory[pose].stamp.ns - trajectory.front().stamp.ns;
    run.curves.rpe_stamp_s.push_back(static_cast<double>(since_ns) * 1e-9);
  }
}

std::string run_figures_json(const RunFigures& run) {
  return json_text(RunJson{{"settings", run.settings},
                           {"sequence", run.sequence},
                           {"variant", run.variant},
                           {"run", run.run},
                           {"values", run.values},
                           {"truth_m", list_of(run.curves.truth_m)},
                           {"estimate_m", list_of(run.curves.estimate_m)},
                           {"rpe_stamp_s", list_of(run.curves.rpe_stamp_s)},
                           {"rpe_m", list_of(run.curves.rpe_m)},
                           {"requested", list_of(run.curves.requested)}});
}

Result<RunFigures> parse_run_figures(std::string_view json, std::string_view origin) {
  const auto read = parse_json(json, origin);
  if (!read) return read.error();
  try {
    return run_of(*read);
  } catch (const std::exception& e) {
    return Error{fmt::format("{}: not the figures of a run: {}", origin, on_one_line(e.what()))};
  }
}

}  // namespace ydd
