// SPDX-License-Identifier: Apache-2.0
#include "ydd/report/html_report.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ydd/base/json_reader.h"
#include "ydd/base/json_text.h"
#include "ydd/base/version.h"
#include "ydd/report/report_html.h"
#include "ydd/report/report_tracks.h"

namespace ydd {
namespace {

using Json = nlohmann::ordered_json;

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < left ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += k <= left ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return out;
}

/// Tenths of a millimetre are more than a plot shows.
double rounded(double value) { return std::round(value * 1e4) / 1e4; }

Json to_json(const Eigen::Vector3d& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

Json rounded(std::span<const double> values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(rounded(value));
  return out;
}

/// Positions in the world of `to_world`, and which way is down there for the camera on average.
Json poses_json(std::span<const StampedPose> poses, const Alignment& to_world) {
  Json stamps = Json::array(), positions = Json::array();
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : poses) {
    stamps.push_back(pose.stamp.seconds());
    positions.push_back(to_json(to_world * pose.T_world_camera.translation()));
    down += to_world.T_target_source.rotation() *
            (pose.T_world_camera.rotation() * Eigen::Vector3d::UnitY());
  }
  if (!poses.empty()) down /= static_cast<double>(poses.size());
  return {{"stamp_s", stamps}, {"xyz", positions}, {"mean_down", to_json(down)}};
}

Json moments_json(std::span<const KeyMoment> moments) {
  Json out = Json::array();
  for (const KeyMoment& moment : moments) {
    out.push_back({{"caption", moment.caption},
                   {"wide", moment.wide},
                   {"image", "data:image/jpeg;base64," + base64(moment.jpeg)}});
  }
  return out;
}

/// Errors pair by pair; empty lists without ground truth.
void add_evaluation(const std::optional<Evaluation>& evaluation, Json& json) {
  json["pairs"] = Json::array();
  json["ate_m"] = Json::array();
  if (!evaluation) return;
  json["evaluation"] = parse_json(format_json(*evaluation), "evaluation").value();
  for (const IndexPair& pair : evaluation->ate.pairs) json["pairs"].push_back({pair.a, pair.b});
  json["ate_m"] = rounded(evaluation->ate.errors_m);
  json["rpe"] = {{"first", evaluation->rpe.first_poses},
                 {"translation_m", rounded(evaluation->rpe.translation_errors_m)},
                 {"rotation_deg", rounded(evaluation->rpe.rotation_errors_deg)}};
}

/// What one run left; its poses are shown where `to_world` puts them.
Result<Json> run_json(const RunReportData& data, const Alignment& to_world) {
  Json json = {{"config", data.config}};
  const std::pair<const char*, const std::string&> texts[] = {
      {"summary", data.summary_json}, {"frames", data.frames_json}, {"timings", data.timings_json}};
  for (const auto& [name, text] : texts) {
    if (text.empty()) {
      json[name] = nullptr;
      continue;
    }
    Result<Json> read = parse_json(text, fmt::format("{} of the run", name));
    if (!read) return read.error();
    json[name] = *std::move(read);
  }
  if (json["timings"].is_object()) json["timings"].erase("series");  // the frames hold them
  json["trajectory"] = poses_json(data.trajectory, to_world);
  add_evaluation(data.evaluation, json);
  return json;
}

/// Pages are UTF-8 whatever the run's files hold.
std::string text_of(const Json& json) { return json_text(json); }

/// Where a run is shown: aligned to the truth, else to the first run, else as it is.
Alignment place_of(const RunReportData& run, const RunReportData& first) {
  if (run.evaluation) return run.evaluation->ate.alignment;
  if (&run == &first) return {};
  const Result<AteResult> to_first = absolute_trajectory_error(first.trajectory, run.trajectory);
  if (!to_first) return {};
  // What the first one is aligned to, this one is as well.
  Alignment out = to_first->alignment;
  if (first.evaluation) {
    const Alignment& outer = first.evaluation->ate.alignment;
    out.T_target_source = SE3(outer.T_target_source.rotation() * out.T_target_source.rotation(),
                              outer * out.T_target_source.translation());
    out.scale *= outer.scale;
  }
  return out;
}

}  // namespace

Result<std::string> html_report(const RunReportData& data) {
  const Alignment place = data.evaluation ? data.evaluation->ate.alignment : Alignment{};
  Result<Json> json = run_json(data, place);
  if (!json) return json.error();
  Result<Json> tracks = tracks_json(data.tracks_jsonl, place);
  if (!tracks) return tracks.error();
  (*json)["tracks"] = *std::move(tracks);
  (*json)["version"] = kVersion;
  (*json)["title"] = data.title;
  (*json)["truth"] = poses_json(data.groundtruth, {});
  (*json)["moments"] = moments_json(data.moments);
  return report_html(data.title, text_of(*json), ReportPage::one_run);
}

Result<std::string> comparison_report(const std::string& title, const StampedPoses& groundtruth,
                                      std::span<const RunReportData> runs) {
  Json json = {{"version", kVersion},
               {"title", title},
               {"truth", poses_json(groundtruth, {})},
               {"runs", Json::array()}};
  for (const RunReportData& run : runs) {
    Result<Json> one = run_json(run, place_of(run, runs.front()));
    if (!one) return Error{run.title + ": " + one.error().message};
    (*one)["name"] = run.title;
    json["runs"].push_back(*std::move(one));
  }
  return report_html(title, text_of(json), ReportPage::comparison);
}

}  // namespace ydd
