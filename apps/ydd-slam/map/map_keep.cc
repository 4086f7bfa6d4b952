// SPDX-License-Identifier: Apache-2.0
// What is kept of a map file: a look at it, some of its maps, what was seen again.
#include <set>

#include <fmt/format.h>

#include "map/map_info.h"
#include "map/map_jobs.h"
#include "ydd/map_files/map_file.h"

namespace ydd::app {
namespace {

Result<void> save_beside(const Atlas& atlas, const std::string& out, bool replace,
                         const MapKey& key) {
  return save_map(atlas, out, replace ? Replacing::anything : Replacing::lesser, key);
}

std::string content_of(const Atlas& atlas) {
  return fmt::format("{} keyframes, {} points", atlas.keyframes().size(), atlas.points().size());
}

}  // namespace

Result<void> map_check(const MapCheckRequest& request) {
  const Result<MapKey> key = MapKey::find(request.map_key);
  if (!key) return key.error();
  const MapCheck check = check_map(request.file, *key);
  if (check.faults.empty()) {
    fmt::print("{}: sound: {} keyframes, {} points, {} {}\n", request.file, check.keyframes,
               check.points, check.maps, check.maps == 1 ? "map" : "maps");
    return {};
  }
  if (check.faults.size() == 1) {
    return Error{fmt::format("{}: {}", request.file, check.faults.front())};
  }
  for (const std::string& fault : check.faults) fmt::print("{}: {}\n", request.file, fault);
  return Error{fmt::format("{}: is damaged in {} places; go back to a copy of it", request.file,
                           check.faults.size())};
}

Result<void> map_prune(const MapPruneRequest& request) {
  const Result<MapKey> key = MapKey::find(request.map_key);
  if (!key) return key.error();
  const Result<Atlas> atlas = load_map(request.file, *key);
  if (!atlas) return atlas.error();
  const Result<PrunedMap> pruned = prune_atlas(*atlas, request.options);
  if (!pruned) return Error{fmt::format("{}: {}", request.file, pruned.error().message)};
  if (auto r = save_beside(pruned->atlas, request.out, request.replace_map, *key); !r) return r;
  fmt::print("{}: {} of {} keyframes, {} of {} points and {} {} were never seen again\n",
             request.file, pruned->keyframes, atlas->keyframes().size(), pruned->points,
             atlas->points().size(), pruned->maps, pruned->maps == 1 ? "map" : "maps");
  fmt::print("{}: {}\n", request.out, content_of(pruned->atlas));
  return {};
}

Result<void> map_split(const MapSplitRequest& request) {
  const Result<MapKey> key = MapKey::find(request.map_key);
  if (!key) return key.error();
  const Result<Atlas> atlas = load_map(request.file, *key);
  if (!atlas) return atlas.error();
  std::set<MapId> there, wanted;
  for (const MapInfo& map : describe_maps(*atlas)) there.insert(map.map);
  for (const int number : request.which) {
    const MapId map{static_cast<std::uint32_t>(number), 1};
    if (!there.contains(map)) {
      return Error{fmt::format("{}: holds no map number {}; 'ydd-slam map info' lists them",
                               request.file, number)};
    }
    wanted.insert(map);
  }
  const Result<Atlas> kept = keep_maps(*atlas, wanted);
  if (!kept) return Error{fmt::format("{}: {}", request.file, kept.error().message)};
  if (auto r = save_beside(*kept, request.out, request.replace_map, *key); !r) return r;
  fmt::print("{}: {} of {} maps, {}\n", request.out, wanted.size(), there.size(),
             content_of(*kept));
  return {};
}

}  // namespace ydd::app
