// SPDX-License-Identifier: Apache-2.0
#include "ydd/report/report_tracks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "ydd/base/json_reader.h"

namespace ydd {
namespace {

using PageJson = nlohmann::ordered_json;

struct Place {
  double stamp_s = 0;
  Eigen::Vector3d p_world;
  double speed_m_s = 0;
};

struct OneTrack {
  std::string class_name;
  std::vector<Place> places;
  int moving = 0;
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();
};

/// None: not three finite numbers.
std::optional<Eigen::Vector3d> vector_of(const PageJson& object, const char* key) {
  const auto it = object.find(key);
  if (it == object.end() || !it->is_array() || it->size() != 3) return std::nullopt;
  Eigen::Vector3d out;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*it)[k].is_number()) return std::nullopt;
    out[static_cast<Eigen::Index>(k)] = (*it)[k].get<double>();
  }
  return out.allFinite() ? std::optional(out) : std::nullopt;
}

double number_of(const PageJson& object, const char* key, double otherwise) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number() ? it->get<double>() : otherwise;
}

/// False: not what a line of tracks looks like.
bool add_frame(const PageJson& frame, std::map<std::int64_t, OneTrack>& tracks) {
  const bool fits = frame.is_object() && frame.contains("stamp_s") &&
                    frame["stamp_s"].is_number() && frame.contains("tracks") &&
                    frame["tracks"].is_array();
  if (!fits) return false;
  for (const PageJson& track : frame["tracks"]) {
    if (!track.is_object() || !track.contains("id") || !track["id"].is_number_integer()) {
      return false;
    }
    const auto position = vector_of(track, "position_m"),
               velocity = vector_of(track, "velocity_m_s"), extent = vector_of(track, "extent_m");
    if (!position || !velocity || !extent) return false;
    if (number_of(track, "unseen_s", 0) > 0) continue;  // where it was not seen it is a guess
    OneTrack& known = tracks[track["id"].get<std::int64_t>()];
    const auto name = track.find("class");
    if (name != track.end() && name->is_string()) known.class_name = name->get<std::string>();
    known.places.push_back({frame["stamp_s"].get<double>(), *position, velocity->norm()});
    const auto moving = track.find("moving");
    known.moving += moving != track.end() && moving->is_boolean() && moving->get<bool>() ? 1 : 0;
    known.extent_m = *extent;
  }
  return true;
}

double to_tenth_mm(double value) { return std::round(value * 1e4) / 1e4; }

PageJson page_json(std::int64_t id, const OneTrack& track, const Alignment& to_world) {
  PageJson stamps = PageJson::array(), xyz = PageJson::array();
  double way_m = 0, sum_m_s = 0, top_m_s = 0;
  for (std::size_t i = 0; i < track.places.size(); ++i) {
    const Place& place = track.places[i];
    const Eigen::Vector3d p = to_world * place.p_world;
    stamps.push_back(place.stamp_s);
    xyz.push_back({to_tenth_mm(p.x()), to_tenth_mm(p.y()), to_tenth_mm(p.z())});
    if (i > 0) way_m += (place.p_world - track.places[i - 1].p_world).norm();
    sum_m_s += place.speed_m_s;
    top_m_s = std::max(top_m_s, place.speed_m_s);
  }
  const auto count = static_cast<double>(track.places.size());
  return {{"id", id},
          {"class", track.class_name},
          {"first_s", track.places.front().stamp_s},
          {"last_s", track.places.back().stamp_s},
          {"seen", track.places.size()},
          {"way_m", to_tenth_mm(way_m)},
          {"mean_m_s", to_tenth_mm(sum_m_s / count)},
          {"top_m_s", to_tenth_mm(top_m_s)},
          {"moving", to_tenth_mm(track.moving / count)},
          {"extent_m",
           {to_tenth_mm(track.extent_m.x()), to_tenth_mm(track.extent_m.y()),
            to_tenth_mm(track.extent_m.z())}},
          {"stamp_s", stamps},
          {"xyz", xyz}};
}

}  // namespace

Result<PageJson> tracks_json(const std::string& jsonl, const Alignment& to_world) {
  std::map<std::int64_t, OneTrack> tracks;
  std::istringstream lines(jsonl);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.empty()) continue;
    const std::string source = fmt::format("tracks of the run, line {}", number);
    const Result<PageJson> frame = parse_json(line, source);
    if (!frame) return frame.error();
    if (!add_frame(*frame, tracks)) return Error{source + ": no frame with tracks"};
  }
  std::vector<std::pair<std::int64_t, const OneTrack*>> order;
  for (const auto& [id, track] : tracks) order.emplace_back(id, &track);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.second->places.size() > b.second->places.size();
  });
  PageJson out = PageJson::array();
  for (const auto& [id, track] : order) out.push_back(page_json(id, *track, to_world));
  return out;
}

}  // namespace ydd
