// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "map/map_jobs.h"
#include "ydd/map_files/map_file.h"
#include "ydd/system/merge_maps.h"
#include "ydd/system/system_options.h"

namespace ydd::app {
namespace {

/// Options of back end and loops as `run` would have them.
Result<SystemOptions> merge_options(const MapMergeRequest& request) {
  SystemOptions options;
  OptionTable table;
  options.describe(table);
  if (!request.config.empty()) {
    if (auto r = table.load_yaml(request.config); !r) return r.error();
  }
  for (const std::string& assignment : request.set) {
    if (auto r = table.set_assignment(assignment, "--set"); !r) return r.error();
  }
  return options;
}

/// What overlapped with what came before, a line each.
std::string report_of(const std::string& file, const MergedMaps& merged) {
  std::string out;
  for (const MapMerge& merge : merged.merges) {
    out += fmt::format(
        "{}: merged map {} onto map {} ({} points agree, {} of its {} keyframes overlap)\n", file,
        merge.map.slot, merge.into.slot, merge.points, merge.overlapping, merge.keyframes);
  }
  if (merged.separate > 0) {
    out += fmt::format("{}: no common place found for {} of its maps: kept beside the others\n",
                       file, merged.separate);
  }
  return out;
}

}  // namespace

Result<void> map_merge(const MapMergeRequest& request) {
  const Result<SystemOptions> options = merge_options(request);
  if (!options) return options.error();
  const Result<MapKey> key = MapKey::find(request.map_key);
  if (!key) return key.error();
  Result<Atlas> all = load_map(request.files.front(), *key);
  if (!all) return all.error();
  std::string report;
  for (std::size_t i = 1; i < request.files.size(); ++i) {
    const std::string& file = request.files[i];
    const Result<Atlas> next = load_map(file, *key);
    if (!next) return next.error();
    Result<MergedMaps> merged = merge_maps(*all, *next, options->mapping, options->loop);
    if (!merged) {
      return Error{
          fmt::format("{} and {}: {}", request.files.front(), file, merged.error().message)};
    }
    report += report_of(file, *merged);
    all = std::move(merged->atlas);
  }
  const Replacing replacing = request.replace_map ? Replacing::anything : Replacing::lesser;
  if (auto r = save_map(*all, request.out, replacing, *key); !r) return r;
  fmt::print("{}{}: {} keyframes, {} points\n", report, request.out, all->keyframes().size(),
             all->points().size());
  return {};
}

}  // namespace ydd::app
