// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_json.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ydd/base/json_text.h"
#include "ydd/evaluation/ate.h"
#include "ydd/pictures/annotate.h"
#include "ydd/pictures/map_from_above.h"

namespace ydd {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoints = 8000;
constexpr std::size_t kMostPoses = 4000;
constexpr std::size_t kRecent = 300;
constexpr std::int64_t kGap_ns = 500'000'000;

std::string text_of(const Json& json) { return json_text(json); }

double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

std::string css(Bgr c) { return fmt::format("#{:02x}{:02x}{:02x}", c[2], c[1], c[0]); }

/// The newest of the history.
std::vector<LiveSample> recent_samples(const LiveFrame& live) {
  std::vector<LiveSample> out;
  std::size_t older = live.history->size() > kRecent ? live.history->size() - kRecent : 0;
  live.history->for_each([&](auto, const LiveSample& sample) {
    if (older > 0) {
      --older;
    } else {
      out.push_back(sample);
    }
  });
  return out;
}

std::vector<TrajectoryEntry> path_of(const LiveFrame& live) {
  std::vector<TrajectoryEntry> out;
  live.history->for_each([&](auto, const LiveSample& s) {
    if (s.reference.valid()) out.push_back({s.stamp, s.reference, s.T_reference_camera});
  });
  return out;
}

/// Poses in the map that the path ended in.
StampedPoses poses_of(const LiveFrame& live) {
  const std::vector<TrajectoryEntry> path = path_of(live);
  StampedPoses out;
  if (path.empty()) return out;
  const MapId map = live.atlas->map_of(path.back().reference);
  for (const TrajectoryEntry& entry : path) {
    const auto T_world_reference = live.atlas->T_world_keyframe(entry.reference);
    if (!T_world_reference || live.atlas->map_of(entry.reference) != map) continue;
    out.push_back({entry.stamp, *T_world_reference * entry.T_reference_camera});
  }
  return out;
}

Json rejected_json(const FilteredFeatures& filtered) {
  Json out = Json::object();
  const auto counts = count_rules(filtered);
  for (std::size_t i = 1; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const Rule rule = static_cast<Rule>(i);
    out[std::string(to_string(rule))] = {{"count", counts[i]}, {"colour", css(colour_of(rule))}};
  }
  return out;
}

Json recent_json(const std::vector<LiveSample>& recent) {
  Json frame = Json::array(), ms = Json::array(), kept = Json::array(), rejected = Json::array();
  for (const LiveSample& s : recent) {
    frame.push_back(s.index);
    ms.push_back(rounded(s.total_ms, 100));
    kept.push_back(s.kept);
    rejected.push_back(s.rejected);
  }
  return {{"frame", frame}, {"ms", ms}, {"kept", kept}, {"rejected", rejected}};
}

int count_maps(const Atlas& atlas) {
  std::vector<MapId> seen;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (std::find(seen.begin(), seen.end(), keyframe.map) == seen.end()) {
      seen.push_back(keyframe.map);
    }
  });
  return static_cast<int>(seen.size());
}

void add(Json& list, const Eigen::Vector2d& p) {
  list.push_back(rounded(p.x(), 1000));
  list.push_back(rounded(p.y(), 1000));
}

Json flat(const std::vector<Eigen::Vector2d>& points) {
  Json out = Json::array();
  for (const Eigen::Vector2d& p : points) add(out, p);
  return out;
}

/// Of a long path every n-th pose, and the last.
Json path_json(const MapFromAbove& map) {
  Json out = Json::array();
  const std::size_t step = map.path.size() / kMostPoses + 1;
  for (std::size_t i = 0; i < map.path.size(); ++i) {
    const bool gap = i > 0 && map.path_stamps[i].ns - map.path_stamps[i - 1].ns > kGap_ns;
    if (gap) {
      out.push_back(nullptr);
      out.push_back(nullptr);
    }
    if (gap || i % step == 0 || i + 1 == map.path.size()) add(out, map.path[i]);
  }
  return out;
}

/// Ground truth from above, moved to where the path is; empty while too little is known.
Json truth_json(const LiveScene& scene, const LiveFrame& live) {
  Json out = Json::array();
  const StampedPoses poses = poses_of(live);
  const auto aligned = absolute_trajectory_error(scene.groundtruth, poses);
  if (!aligned || !aligned->alignment.unique) return out;
  const SE3 T_estimate_truth = aligned->alignment.T_target_source.inverse();
  const std::size_t step = aligned->pairs.size() / kMostPoses + 1;
  for (std::size_t i = 0; i < aligned->pairs.size(); i += step) {
    const Eigen::Vector3d p =
        T_estimate_truth * scene.groundtruth[aligned->pairs[i].a].T_world_camera.translation();
    add(out, {p.x(), p.z()});
  }
  return out;
}

void append_float(std::string& out, double value) {
  static_assert(std::endian::native == std::endian::little);
  const float narrow = static_cast<float>(value);
  char bytes[sizeof(narrow)];
  std::memcpy(bytes, &narrow, sizeof(narrow));
  out.append(bytes, sizeof(narrow));
}

}  // namespace

std::string live_state_json(const LiveScene& scene, const LiveFrame& live) {
  const FrameReport& report = *live.report;
  const LiveStatus& status = live.status;
  const Variant variant = scene.has_detector ? status.variant : without_boxes(status.variant);
  Json stages = Json::object();
  for (const StageTime& time : report.times) stages[time.stage] = rounded(time.wall_ms, 100);
  return text_of({{"sequence", scene.sequence},
                  {"frames", scene.frames},
                  {"serial", live.serial},
                  {"frame", report.index},
                  {"stamp_s", report.stamp.seconds()},
                  {"state", std::string(to_string(report.track.state))},
                  {"paused", status.paused},
                  {"localization_only", status.localization_only},
                  {"finished", status.finished},
                  {"variant", std::string(to_string(variant))},
                  {"has_detector", scene.has_detector},
                  {"fps", rounded(status.frames_per_second, 10)},
                  {"message", status.message},
                  {"resets", status.resets},
                  {"keyframes", live.atlas->keyframes().size()},
                  {"points", live.atlas->points().size()},
                  {"maps", count_maps(*live.atlas)},
                  {"requested", report.requested},
                  {"kept", report.filtered->kept->size()},
                  {"inliers", report.track.inliers},
                  {"rejected", rejected_json(*report.filtered)},
                  {"boxes", report.detections.size()},
                  {"stages_ms", stages},
                  {"recent", recent_json(recent_samples(live))}});
}

std::string live_map_json(const LiveScene& scene, const LiveFrame& live) {
  const MapFromAbove map = map_from_above(*live.atlas, path_of(live), kMostPoints);
  Json loops = Json::array();
  for (const auto& [a, b] : map.loops) {
    Json ends = Json::array();
    add(ends, a);
    add(ends, b);
    loops.push_back(ends);
  }
  Json camera;
  if (!map.path.empty()) {
    camera = Json::array();
    add(camera, map.path.back());
    camera.push_back(rounded(std::atan2(map.ahead.y(), map.ahead.x()), 1000));
  }
  Json tracks = Json::array();
  for (const WorldTrack& track : live.report->tracks) {
    Json one = Json::array();
    add(one, {track.position_m.x(), track.position_m.z()});
    add(one, {track.velocity_m_s.x(), track.velocity_m_s.z()});
    one.push_back(track.id);
    one.push_back(track.class_name);
    tracks.push_back(std::move(one));
  }
  return text_of({{"serial", live.serial},
                  {"resets", live.status.resets},
                  {"tracks", tracks},
                  {"points", flat(map.points)},
                  {"keyframes", flat(map.keyframes)},
                  {"path", path_json(map)},
                  {"truth", truth_json(scene, live)},
                  {"loops", loops},
                  {"camera", camera},
                  {"lost", live.report->track.state == TrackingState::lost}});
}

std::string live_trajectory_tum(const LiveFrame& live) {
  return format_trajectory(poses_of(live), TrajectoryFormat::tum);
}

std::string live_map_ply(const LiveFrame& live) {
  std::string points;
  std::size_t count = 0;
  live.atlas->points().for_each([&](MapPointId, const MapPoint& point) {
    for (int k = 0; k < 3; ++k) append_float(points, point.p_world[k]);
    ++count;
  });
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
             "property float y\nproperty float z\nend_header\n",
             count) +
         points;
}

}  // namespace ydd
