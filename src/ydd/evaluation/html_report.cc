// SPDX-License-Identifier: Apache-2.0
#include "ydd/evaluation/html_report.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report_assets.inc"
#include "ydd/base/version.h"

namespace ydd {
namespace {

using Json = nlohmann::ordered_json;

std::string joined(std::span<const std::string_view> pieces) {
  std::string out;
  for (const std::string_view piece : pieces) out += piece;
  return out;
}

/// `text` with every `mark` replaced, in one pass: what was filled in is not looked at again.
std::string filled(std::string_view text,
                   std::span<const std::pair<std::string_view, std::string>> marks) {
  std::string out;
  while (!text.empty()) {
    const auto at = text.find('@');
    out += text.substr(0, at);
    if (at == std::string_view::npos) break;
    text.remove_prefix(at);
    std::string_view taken = text.substr(0, 1), by = taken;
    for (const auto& [mark, content] : marks) {
      if (text.starts_with(mark)) std::tie(taken, by) = std::pair(mark, std::string_view(content));
    }
    out += by;
    text.remove_prefix(taken.size());
  }
  return out;
}

std::string replaced(std::string_view text, char what, std::string_view by) {
  std::string out;
  for (const char c : text) c == what ? out.append(by) : out.append(1, c);
  return out;
}

std::string html_text(std::string_view text) {
  return replaced(replaced(text, '&', "&amp;"), '<', "&lt;");
}

/// JSON that no HTML parser mistakes for a tag: outside strings it has no '<' anyway.
std::string script_text(const Json& json) {
  return replaced(json.dump(-1, ' ', false, Json::error_handler_t::replace), '<', "\\u003c");
}

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
    out.push_back(
        {{"caption", moment.caption}, {"image", "data:image/jpeg;base64," + base64(moment.jpeg)}});
  }
  return out;
}

/// Errors pair by pair; empty lists without ground truth.
void add_evaluation(const std::optional<Evaluation>& evaluation, Json& json) {
  json["pairs"] = Json::array();
  json["ate_m"] = Json::array();
  if (!evaluation) return;
  json["evaluation"] = Json::parse(format_json(*evaluation));
  for (const IndexPair& pair : evaluation->ate.pairs) json["pairs"].push_back({pair.a, pair.b});
  json["ate_m"] = rounded(evaluation->ate.errors_m);
  json["rpe"] = {{"first", evaluation->rpe.first_poses},
                 {"translation_m", rounded(evaluation->rpe.translation_errors_m)},
                 {"rotation_deg", rounded(evaluation->rpe.rotation_errors_deg)}};
}

Result<Json> data_json(const RunReportData& data) {
  Json json = {{"version", kVersion}, {"title", data.title}, {"config", data.config}};
  const std::pair<const char*, const std::string&> texts[] = {
      {"summary", data.summary_json}, {"frames", data.frames_json}, {"timings", data.timings_json}};
  for (const auto& [name, text] : texts) {
    json[name] = text.empty() ? Json() : Json::parse(text, nullptr, false);
    if (json[name].is_discarded()) return Error{fmt::format("{} of the run: not JSON", name)};
  }
  if (json["timings"].is_object()) json["timings"].erase("series");  // the frames hold them
  json["trajectory"] =
      poses_json(data.trajectory, data.evaluation ? data.evaluation->ate.alignment : Alignment{});
  json["truth"] = poses_json(data.groundtruth, {});
  json["moments"] = moments_json(data.moments);
  add_evaluation(data.evaluation, json);
  return json;
}

}  // namespace

Result<std::string> html_report(const RunReportData& data) {
  const Result<Json> json = data_json(data);
  if (!json) return json.error();
  const std::pair<std::string_view, std::string> marks[] = {
      {"@TITLE@", html_text(data.title)},   {"@LIBRARY_CSS@", joined(kLibraryCss)},
      {"@LIBRARY_JS@", joined(kLibraryJs)}, {"@PAGE_JS@", joined(kPageJs)},
      {"@DATA@", script_text(*json)},
  };
  return filled(joined(kTemplate), marks);
}

}  // namespace ydd
