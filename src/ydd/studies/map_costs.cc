// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/map_costs.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "ydd/base/interruption.h"
#include "ydd/base/timing.h"
#include "ydd/loop/loop_closer.h"
#include "ydd/map/local_map.h"
#include "ydd/map_files/map_file.h"
#include "ydd/mapping/apply_correction.h"
#include "ydd/mapping/mapper.h"
#include "ydd/place/place_query.h"
#include "ydd/system/nearby_map.h"
#include "ydd/tracking/tracker.h"

namespace ydd {
namespace {

constexpr std::size_t kSamples = 100;  // places asked for, local maps
constexpr std::size_t kWalks = 8;      // rooms that a camera is lost and tracked in
constexpr std::size_t kFramesOfWalk = 15;
constexpr std::size_t kInserted = 24;
constexpr std::size_t kInsertedInARow = 4;

struct Spent {
  double cpu_ms = 0, wall_ms = 0;
};

template <class Step>
Spent spent_on(Step&& step) {
  const std::int64_t cpu_ns = thread_cpu_ns();
  const std::int64_t wall_ns = wall_clock_ns();
  step();
  return {static_cast<double>(thread_cpu_ns() - cpu_ns) * 1e-6,
          static_cast<double>(wall_clock_ns() - wall_ns) * 1e-6};
}

/// What this process has given to the system to be written so far; 0 where it does not tell.
std::int64_t bytes_written() {
  std::ifstream file("/proc/self/io");
  std::string name;
  std::int64_t value = 0;
  while (file >> name >> value) {
    if (name == "wchar:") return value;
  }
  return 0;
}

/// `wanted` of `size` numbers, spread evenly.
std::vector<std::size_t> spread(std::size_t size, std::size_t wanted) {
  std::vector<std::size_t> out;
  const std::size_t n = std::min(size, wanted);
  for (std::size_t i = 0; i < n; ++i) out.push_back(i * size / n);
  return out;
}

/// Whether two keyframes show the same place: they stand side by side.
bool side_by_side(const Atlas& atlas, KeyFrameId a, KeyFrameId b) {
  const SE3 T_a_b = atlas.at(a).T_world_camera.inverse() * atlas.at(b).T_world_camera;
  return T_a_b.translation().norm() < 0.6 && T_a_b.angle_rad() < 0.35;
}

void measure_queries(const Atlas& atlas, const std::vector<Revisit>& revisits,
                     const LoopOptions& options, MapCosts& costs) {
  constexpr std::size_t kPerPlace = 6;  // as a loop asks
  for (const std::size_t i : spread(revisits.size(), kSamples)) {
    const KeyFrame& again = atlas.at(revisits[i].again);
    const auto admit = [&](KeyFrameId id) { return atlas.at(id).map != again.map; };
    std::vector<PlaceCandidate> found;
    costs.query_ms.push_back(spent_on([&] {
                               found = query_places(
                                   atlas, *again.words, admit,
                                   kPerPlace * static_cast<std::size_t>(options.candidates));
                             }).cpu_ms);
    if (!found.empty() && side_by_side(atlas, found.front().keyframe, revisits[i].before)) {
      ++costs.recognised;
    }
  }
}

void measure_local_maps(const Atlas& atlas, const TrackerOptions& options, MapCosts& costs) {
  const std::vector<KeyFrameId> ids = atlas.keyframes().ids();
  for (const std::size_t i : spread(ids.size(), kSamples)) {
    const KeyFrame& keyframe = atlas.at(ids[i]);
    std::vector<MapPointId> seen;
    for (const MapPointId id : keyframe.points) {
      if (id.valid()) seen.push_back(id);
    }
    costs.gather_ms.push_back(spent_on([&] {
                                gather_local_map(atlas, seen, ids[i], options.max_local_keyframes);
                                most_shared_keyframe(atlas, keyframe.points);
                              }).cpu_ms);
  }
}

/// A camera that is put into a room and sees what its keyframes saw.
void measure_tracking(const Atlas& atlas, const std::vector<KeyFrameId>& seen_once,
                      const TrackerOptions& options, MapCosts& costs) {
  for (const std::size_t start : spread(seen_once.size(), kWalks)) {
    interruption::throw_if_asked();
    Tracker tracker(options, true);
    for (std::size_t k = 0; k < kFramesOfWalk && start + k < seen_once.size(); ++k) {
      const KeyFrame& keyframe = atlas.at(seen_once[start + k]);
      const bool tracked = tracker.state() == TrackingState::tracking;
      TrackResult result;
      const double ms =
          spent_on([&] { result = tracker.track(as_frame(keyframe), atlas, true); }).cpu_ms;
      (tracked ? costs.track_ms : costs.relocalise_ms).push_back(ms);
      if (tracked && result.state != TrackingState::tracking) ++costs.lost_frames;
    }
  }
}

/// The keyframe once more, as the tracker would propose it: most of its points are known.
KeyFrameCandidate candidate_of(const Atlas& atlas, KeyFrameId id, std::size_t number) {
  const KeyFrame& keyframe = atlas.at(id);
  TrackedFrame frame = as_frame(keyframe);
  frame.index = 4 * atlas.next_serial();
  frame.stamp = {atlas.at(atlas.newest_keyframe()).stamp.ns + 400'000'000};
  frame.T_camera_world = keyframe.T_world_camera.inverse();
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    if ((i + number) % 4 != 0) frame.points[i] = keyframe.points[i];
  }
  return {std::move(frame), id, SE3(), {}};
}

void measure_insertion(Mapper& mapper, const LoopOptions& options, MapCosts& costs) {
  const std::vector<KeyFrameId> ids = mapper.atlas().keyframes().ids();
  std::shared_ptr<const Atlas> published = mapper.snapshot();
  for (const std::size_t start : spread(ids.size(), kInserted / kInsertedInARow)) {
    for (std::size_t k = 0; k < kInsertedInARow && start + k < ids.size(); ++k) {
      interruption::throw_if_asked();
      if (!mapper.atlas().find(ids[start + k])) continue;  // culled since
      const KeyFrameCandidate candidate = candidate_of(mapper.atlas(), ids[start + k], k);
      MapperReport report;
      costs.insert_ms.push_back(spent_on([&] { report = mapper.process(candidate); }).cpu_ms);
      costs.publish_ms.push_back(spent_on([&] { published = mapper.snapshot(); }).cpu_ms);
      costs.look_ms.push_back(
          spent_on([&] { (void)find_loop(*published, report.keyframe, options); }).cpu_ms);
      ++costs.new_keyframes;
    }
  }
}

/// The first session ends where it began, ten centimetres off.
void measure_loop(Mapper& mapper, const LoopOptions& options, MapCosts& costs) {
  const auto atlas = mapper.snapshot();
  KeyFrameId first, last;
  atlas->keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.map.slot != 0) return;
    if (!first.valid() || keyframe.serial < atlas->at(first).serial) first = id;
    if (!last.valid() || keyframe.serial > atlas->at(last).serial) last = id;
  });
  Vector6d drift;
  drift << 0.1, 0, 0, 0, 0.01, 0;
  const LoopMatch match{last, first, atlas->at(last).T_world_camera * SE3::exp(drift), {}};
  std::optional<Correction> correction;
  costs.correct_ms = spent_on([&] { correction = correct_loop(*atlas, match, options); }).cpu_ms;
  if (!correction) return;
  costs.prepare_ms = spent_on([&] { prepare_correction(atlas, *correction); }).cpu_ms;
  costs.apply_ms = spent_on([&] { (void)mapper.apply(*correction); }).cpu_ms;
}

using Walks = std::vector<std::vector<TrackedFrame>>;

/// What a camera sees that is put into some rooms.
Walks walks_of(const Atlas& atlas, const std::vector<KeyFrameId>& seen_once) {
  Walks walks;
  for (const std::size_t start : spread(seen_once.size(), kWalks)) {
    walks.emplace_back();
    for (std::size_t k = 0; k < kFramesOfWalk && start + k < seen_once.size(); ++k) {
      walks.back().push_back(as_frame(atlas.at(seen_once[start + k])));
    }
  }
  return walks;
}

/// The walks once more, in the file of the map.
Result<void> measure_in_part(const std::filesystem::path& file, const Walks& walks,
                             const SystemOptions& options, const ResidentMemory& resident_mb,
                             MapCosts& costs) {
  NearbyOptions nearby;
  nearby.in_background = false;
  const double before_mb = resident_mb();
  Result<std::unique_ptr<NearbyMap>> map = Error{""};
  costs.open_ms = spent_on([&] {
                    Result<StoredMap> stored = StoredMap::open(file);
                    map = stored ? NearbyMap::open(std::move(*stored), nearby)
                                 : Result<std::unique_ptr<NearbyMap>>(stored.error());
                  }).cpu_ms;
  if (!map) return map.error();
  costs.opened_mb = resident_mb() - before_mb;
  for (const std::vector<TrackedFrame>& walk : walks) {
    Tracker tracker(options.tracking, true);
    tracker.set_localization_only(true);
    for (const TrackedFrame& frame : walk) {
      if (tracker.state() == TrackingState::lost) {
        const auto words = std::make_shared<const BagOfWords>(
            bag_of_words(builtin_vocabulary(), frame.features().descriptors));
        costs.place_ms.push_back(spent_on([&] { (*map)->look_for(words); }).cpu_ms);
      }
      const bool tracked = tracker.state() == TrackingState::tracking;
      const TrackResult result = tracker.track(frame, *(*map)->atlas(), true);
      if (tracked && result.state != TrackingState::tracking) ++costs.lost_in_part;
      if (!result.reference.valid()) continue;
      const auto before = (*map)->atlas();
      const double ms = spent_on([&] { (*map)->follow(result.reference); }).cpu_ms;
      if ((*map)->atlas() != before) costs.near_ms.push_back(ms);
    }
  }
  costs.walked_mb = resident_mb() - before_mb;
  return (*map)->failure();
}

Result<MapSave> timed_save(MapWriter& writer, Mapper& mapper, Spent& spent, std::int64_t& bytes) {
  const auto atlas = mapper.snapshot();
  const std::int64_t before = bytes_written();
  Result<MapSave> saved = Error{""};
  spent = spent_on([&] { saved = writer.save(atlas); });
  bytes = bytes_written() - before;
  return saved;
}

}  // namespace

Result<MapCosts> measure_map(Building building, const SystemOptions& system_options,
                             const std::filesystem::path& file, const ResidentMemory& resident_mb) {
  const SystemOptions options = system_options.resolved();
  MapCosts costs;
  costs.keyframes = building.atlas.keyframes().size();
  costs.points = building.atlas.points().size();
  Result<MapWriter> writer = MapWriter::open(file, Replacing::anything);
  if (!writer) return writer.error();
  const Walks walks = walks_of(building.atlas, building.seen_once);
  {
    Mapper mapper(std::move(building.atlas), options.mapping);
    const auto atlas = mapper.snapshot();
    measure_queries(*atlas, building.revisits, options.loop, costs);
    measure_local_maps(*atlas, options.tracking, costs);
    measure_tracking(*atlas, building.seen_once, options.tracking, costs);
    Spent spent;
    if (auto r = timed_save(*writer, mapper, spent, costs.save_whole_bytes); !r) return r.error();
    costs.save_whole_ms = spent.cpu_ms;
    costs.save_whole_wall_ms = spent.wall_ms;
    measure_insertion(mapper, options.loop, costs);
    const Result<MapSave> saved = timed_save(*writer, mapper, spent, costs.save_new_bytes);
    if (!saved) return saved.error();
    costs.save_new_ms = spent.cpu_ms;
    costs.save_new_wall_ms = spent.wall_ms;
    costs.save_new_rows = saved->rows;
    measure_loop(mapper, options.loop, costs);
  }
  {
    Result<Atlas> loaded = Error{""};
    costs.load_ms = spent_on([&] { loaded = load_map(file); }).cpu_ms;
    if (!loaded) return loaded.error();
  }
  if (auto r = measure_in_part(file, walks, options, resident_mb, costs); !r) return r.error();
  return costs;
}

double fitted_exponent(const std::vector<double>& sizes, const std::vector<double>& costs) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < sizes.size() && i < costs.size(); ++i) {
    if (!(sizes[i] > 0) || !(costs[i] > 0)) continue;
    const double log_size = std::log(sizes[i]);
    const double log_cost = std::log(costs[i]);
    n += 1;
    x += log_size;
    y += log_cost;
    xx += log_size * log_size;
    xy += log_size * log_cost;
  }
  const double spread_of_sizes = n * xx - x * x;
  if (!(spread_of_sizes > 1e-9)) return std::numeric_limits<double>::quiet_NaN();
  return (n * xy - x * y) / spread_of_sizes;
}

}  // namespace ydd
