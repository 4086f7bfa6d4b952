// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/building.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace ydd {
namespace {

constexpr double kRoomPitch_m = 12.0;
constexpr double kFloorHeight_m = 3.5;
constexpr std::int64_t kStampStep_ns = 400'000'000;
constexpr int kRoomHalvings = 2;                  // 64 of 256 tests: copies of a room are 96 apart
constexpr int kDayHalvings = 5;                   // 8 tests
constexpr std::uint64_t kPointKey = 1ULL << 62U;  // keys of points and of keypoints without one

/// A number that each of its arguments changes wholly (Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014).
std::uint64_t mixed(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15ULL;
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31U);
}

/// Turns round each test with probability 2^-halvings, by the key alone.
void turn_tests(Descriptor& descriptor, std::uint64_t key, int halvings) {
  for (std::size_t i = 0; i < descriptor.size(); ++i) {
    std::uint64_t mask = ~0ULL;
    for (int k = 0; k < halvings; ++k) {
      mask &= mixed(key ^ mixed(8 * i + static_cast<std::uint64_t>(k)));
    }
    descriptor[i] ^= mask;
  }
}

/// A mapped room without gaps: keyframes in the order of creation, points numbered anew.
struct Template {
  const Atlas* atlas = nullptr;
  std::vector<KeyFrameId> keyframes;
  std::vector<MapPointId> points;
  std::vector<std::uint32_t> keyframe_at, point_at;  ///< place in these lists, by slot
};

Template template_of(const Atlas& atlas) {
  Template out;
  out.atlas = &atlas;
  out.keyframes = atlas.keyframes().ids();
  if (out.keyframes.empty()) throw std::logic_error("grow_building: a room without keyframes");
  std::sort(out.keyframes.begin(), out.keyframes.end(),
            [&](KeyFrameId a, KeyFrameId b) { return atlas.at(a).serial < atlas.at(b).serial; });
  out.points = atlas.points().ids();
  out.keyframe_at.resize(atlas.keyframes().slots());
  out.point_at.resize(atlas.points().slots());
  for (std::size_t i = 0; i < out.keyframes.size(); ++i) {
    out.keyframe_at[out.keyframes[i].slot] = static_cast<std::uint32_t>(i);
  }
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    out.point_at[out.points[i].slot] = static_cast<std::uint32_t>(i);
  }
  return out;
}

/// One visit to one room.
struct Visit {
  const Template* room = nullptr;
  std::uint64_t look = 0;    ///< key of how the room looks
  std::uint64_t change = 0;  ///< key of what is different on this visit; 0: nothing
  SE3 T_building_room;
  MapId map;
  KeyFrameId follows;  ///< the keyframe before its first; empty: it starts the map
};

/// Adds visits to the parts of an atlas.
class Builder {
 public:
  explicit Builder(const Atlas& like) {
    parts_.camera = like.camera();
    parts_.scales = like.scales();
  }

  std::size_t keyframes() const { return parts_.keyframes.size(); }
  KeyFrameId newest() const { return parts_.newest; }

  /// The keyframes of the visit stand in the order of the template from the given number on.
  std::size_t add(const Visit& visit) {
    const Template& room = *visit.room;
    first_keyframe_ = static_cast<std::uint32_t>(parts_.keyframes.size());
    first_point_ = static_cast<std::uint32_t>(parts_.points.size());
    for (std::size_t i = 0; i < room.keyframes.size(); ++i) {
      parts_.keyframes.emplace_back(keyframe_at(i), keyframe(visit, room.keyframes[i], i == 0));
      parts_.newest = parts_.keyframes.back().first;
    }
    for (const MapPointId id : room.points) {
      parts_.points.emplace_back(point_id(room, id), point(visit, id));
    }
    parts_.maps = std::max(parts_.maps, visit.map.slot + 1);
    return first_keyframe_;
  }

  Atlas finish() {
    parts_.next_serial = static_cast<std::int64_t>(parts_.keyframes.size());
    parts_.revision = parts_.keyframes.size();
    Result<Atlas> atlas = Atlas::restore(std::move(parts_));
    if (!atlas) throw std::logic_error("grow_building: " + atlas.error().message);
    return std::move(*atlas);
  }

 private:
  KeyFrameId keyframe_at(std::size_t i) const {
    return {first_keyframe_ + static_cast<std::uint32_t>(i), 1};
  }
  KeyFrameId keyframe_id(const Template& room, KeyFrameId id) const {
    return keyframe_at(room.keyframe_at[id.slot]);
  }
  MapPointId point_id(const Template& room, MapPointId id) const {
    return {first_point_ + room.point_at[id.slot], 1};
  }

  KeyFrame keyframe(const Visit& visit, KeyFrameId id, bool first) const {
    const Template& room = *visit.room;
    const KeyFrame& original = room.atlas->at(id);
    KeyFrame k;
    k.serial = static_cast<std::int64_t>(parts_.keyframes.size());
    k.frame_index = 4 * k.serial;
    k.stamp = {1'000'000'000 + kStampStep_ns * k.serial};
    k.map = visit.map;
    k.T_world_camera = visit.T_building_room * original.T_world_camera;
    k.grid = original.grid;  // keypoints are where they were
    k.shared_features = looks(visit, original, id.slot);
    k.words = std::make_shared<const BagOfWords>(
        bag_of_words(builtin_vocabulary(), k.features().descriptors));
    for (const Covisible& c : original.covisible) {
      k.covisible.push_back({keyframe_id(room, c.keyframe), c.weight});
    }
    for (const KeyFrameId loop : original.loops) {
      if (room.atlas->find(loop)) k.loops.push_back(keyframe_id(room, loop));
    }
    k.parent = original.parent.valid() ? keyframe_id(room, original.parent) : visit.follows;
    if (first) k.parent = visit.follows;
    return k;
  }

  static std::shared_ptr<const Features> looks(const Visit& visit, const KeyFrame& original,
                                               std::uint32_t slot) {
    auto features = std::make_shared<Features>(original.features());
    for (std::size_t i = 0; i < features->size(); ++i) {
      const MapPointId point = original.points[i];
      const std::uint64_t own = (std::uint64_t{slot} << 20U) + i;
      const std::uint64_t key = point.valid() ? kPointKey + point.slot : own;
      turn_tests(features->descriptors[i], mixed(visit.look) ^ key, kRoomHalvings);
      if (visit.change != 0) {
        turn_tests(features->descriptors[i], mixed(visit.change) ^ mixed(own), kDayHalvings);
      }
    }
    return features;
  }

  MapPoint point(const Visit& visit, MapPointId id) const {
    MapPoint p = visit.room->atlas->at(id);
    p.p_world = visit.T_building_room * p.p_world;
    p.normal = visit.T_building_room.rotation() * p.normal;
    turn_tests(p.descriptor, mixed(visit.look) ^ (kPointKey + id.slot), kRoomHalvings);
    for (Observation& s : p.observations) s.keyframe = keyframe_id(*visit.room, s.keyframe);
    p.born = static_cast<std::int64_t>(p.observations.front().keyframe.slot);
    return p;
  }

  AtlasParts parts_;
  std::uint32_t first_keyframe_ = 0, first_point_ = 0;
};

/// World frame: y down, so that floors lie above each other towards negative y.
SE3 place_of_room(int room, const BuildingOptions& options) {
  const int floor = room / options.rooms_per_floor;
  const int on_floor = room % options.rooms_per_floor;
  const int column = on_floor % options.rooms_per_row;
  const int row = on_floor / options.rooms_per_row;
  Vector6d shift;
  shift << column * kRoomPitch_m, -floor * kFloorHeight_m, row * kRoomPitch_m, 0, 0, 0;
  return SE3::exp(shift);
}

struct PlannedVisit {
  int room = 0;
  bool again = false;
  std::size_t first = 0;  ///< number of its first keyframe
};

/// Rooms of the first session, then those that the second sees again.
std::vector<PlannedVisit> plan(const std::vector<Template>& templates,
                               const BuildingOptions& options) {
  std::vector<PlannedVisit> visits, again;
  std::size_t keyframes = 0;
  for (int room = 0; keyframes < options.keyframes; ++room) {
    const std::size_t size =
        templates[static_cast<std::size_t>(room) % templates.size()].keyframes.size();
    visits.push_back({room, false, 0});
    keyframes += size;
    if (options.revisit_every > 0 && room % options.revisit_every == 0) {
      again.push_back({room, true, 0});
      keyframes += size;
    }
  }
  visits.insert(visits.end(), again.begin(), again.end());
  return visits;
}

}  // namespace

Building grow_building(const std::vector<std::shared_ptr<const Atlas>>& rooms,
                       const BuildingOptions& options) {
  if (rooms.empty()) throw std::logic_error("grow_building: no rooms");
  std::vector<Template> templates;
  for (const auto& room : rooms) templates.push_back(template_of(*room));
  Builder builder(*rooms.front());
  std::vector<PlannedVisit> visits = plan(templates, options);
  for (PlannedVisit& v : visits) {
    const auto room = static_cast<std::uint64_t>(v.room);
    Visit visit;
    visit.room = &templates[static_cast<std::size_t>(v.room) % templates.size()];
    visit.look = mixed(options.seed) + 2 * room;
    visit.change = v.again ? mixed(options.seed) + 2 * room + 1 : 0;
    visit.T_building_room = place_of_room(v.room, options);
    visit.map = {v.again ? 1U : 0U, 1};
    const bool starts = &v == &visits.front() || (v.again && !(&v - 1)->again);
    if (!starts) visit.follows = builder.newest();
    v.first = builder.add(visit);
  }
  Building out{builder.finish(), {}, {}};
  for (const PlannedVisit& visit : visits) {
    if (visit.again) continue;
    const auto again = std::find_if(visits.begin(), visits.end(), [&](const PlannedVisit& v) {
      return v.again && v.room == visit.room;
    });
    const auto& room = templates[static_cast<std::size_t>(visit.room) % templates.size()];
    for (std::size_t i = 0; i < room.keyframes.size(); ++i) {
      const KeyFrameId id{static_cast<std::uint32_t>(visit.first + i), 1};
      if (again == visits.end()) {
        out.seen_once.push_back(id);
      } else {
        out.revisits.push_back({id, {static_cast<std::uint32_t>(again->first + i), 1}});
      }
    }
  }
  return out;
}

}  // namespace ydd
