// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "bench/bench_seeds.h"
#include "common/scratch_folder.h"
#include "run/run_job.h"
#include "ydd/base/log.h"
#include "ydd/place/place_query.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// What counts as the same place: so near in space and direction that the pictures share things.
constexpr double kNear_m = 0.6;
constexpr double kNear_rad = 0.35;
// Older than this, or it would only be the next moment of the same look.
constexpr double kApart_s = 6.0;
constexpr std::size_t kCandidates = 5;
constexpr std::size_t kPerPlace = 6;
constexpr double kRight_m = 0.10;  // of a verified pose
constexpr double kRight_rad = 0.05;

/// A keyframe with the pose that it really had.
struct Place {
  KeyFrameId id;
  SE3 T_true_camera;
};

struct Counts {
  int queries = 0;            ///< keyframes of a place that was seen long before
  int strangers = 0;          ///< keyframes of a place that was not
  std::vector<double> right;  ///< scores of best candidates that are the place
  std::vector<double> wrong;  ///< and of those that are not
  int verified_right = 0, verified_wrong = 0;

  double top1_recall() const { return share(static_cast<int>(right.size())); }
  /// Share of the revisits above the best score of a wrong answer.
  double recall_at_full_precision() const {
    const double limit = wrong.empty() ? 0.0 : *std::max_element(wrong.begin(), wrong.end());
    return share(static_cast<int>(
        std::count_if(right.begin(), right.end(), [&](double score) { return score > limit; })));
  }
  double share(int n) const { return queries == 0 ? 0.0 : static_cast<double>(n) / queries; }
};

bool same_place(const SE3& a, const SE3& b) {
  const SE3 T_a_b = a.inverse() * b;
  return T_a_b.translation().norm() < kNear_m && T_a_b.angle_rad() < kNear_rad;
}

/// Whether the verified pose of `query` relative to the recognised keyframe is the true one.
bool is_right(const Atlas& atlas, const Relocalization& found, const Place& query,
              const std::vector<Place>& places) {
  const auto place = std::find_if(places.begin(), places.end(),
                                  [&](const Place& p) { return p.id == found.keyframe; });
  if (place == places.end()) return false;
  const SE3 measured =
      atlas.at(found.keyframe).T_world_camera.inverse() * found.T_camera_world.inverse();
  const SE3 error = (place->T_true_camera.inverse() * query.T_true_camera).inverse() * measured;
  return error.translation().norm() < kRight_m && error.angle_rad() < kRight_rad;
}

/// Asks for the place of one keyframe among those that are long past.
void ask(const Atlas& atlas, const Place& query, const std::vector<Place>& places,
         const LoopOptions& options, Counts& counts) {
  const KeyFrame& keyframe = atlas.at(query.id);
  const auto past = [&](KeyFrameId id) {
    return seconds_between(atlas.at(id).stamp, keyframe.stamp) > kApart_s;
  };
  const bool revisit = std::any_of(places.begin(), places.end(), [&](const Place& p) {
    return past(p.id) && same_place(p.T_true_camera, query.T_true_camera);
  });
  ++(revisit ? counts.queries : counts.strangers);
  const auto candidates = query_places(atlas, *keyframe.words, past, kPerPlace * kCandidates);
  if (candidates.empty()) return;
  const auto best = std::find_if(places.begin(), places.end(), [&](const Place& p) {
    return p.id == candidates.front().keyframe;
  });
  const bool right = best != places.end() && same_place(best->T_true_camera, query.T_true_camera);
  (right ? counts.right : counts.wrong).push_back(candidates.front().score);
  std::vector<KeyFrameId> ids;
  for (const PlaceCandidate& c : distinct_places(atlas, candidates, kCandidates)) {
    ids.push_back(c.keyframe);
  }
  RelocalizationOptions strict = options.match;
  strict.min_inliers = options.min_inliers;
  const auto found =
      relocalize_uniquely(atlas, as_frame(keyframe), ids, strict, PoseOnlyOptions(), MatchLimits());
  if (!found) return;
  const bool true_pose = is_right(atlas, *found, query, places);
  if (!true_pose) ++counts.verified_wrong;
  if (true_pose && revisit) ++counts.verified_right;
}

void add_atlas(const Atlas& atlas, const std::vector<Place>& places, Counts& counts) {
  for (const Place& query : places) ask(atlas, query, places, LoopOptions(), counts);
}

/// Two rounds of a walk, mapped without closing loops.
Result<void> add_walk(const SeedRequest& request, int seed, bool look_alike, Counts& counts) {
  WorldOptions world = walk_world(request, seed, look_alike ? 2 : 1);
  world.repeated_posters = world.identical_desks = look_alike;
  world.frames =
      static_cast<int>((look_alike ? 1.6 : 2.0) * make_camera_path(world).round_s * request.fps);
  Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  options->deterministic = true;
  options->loop.enabled = false;
  const Simulator simulator(world);
  const Result<SimulatedRun> run = run_simulated(simulator, *options);
  if (!run) return run.error();
  std::vector<Place> places;
  run->atlas->keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    places.push_back({id, simulator.pose(static_cast<int>(keyframe.frame_index))});
  });
  add_atlas(*run->atlas, places, counts);
  log::info("seed {}: {} keyframes, {} revisits so far", seed, places.size(), counts.queries);
  return {};
}

std::string row(const std::string& name, const Counts& c) {
  return fmt::format("| {} | {} | {} | {:.1f} % | {:.1f} % | {:.1f} % | {} |\n", name, c.queries,
                     c.strangers, 100 * c.top1_recall(), 100 * c.recall_at_full_precision(),
                     100 * c.share(c.verified_right), c.verified_wrong);
}

Json to_json(const std::string& name, const Counts& c) {
  return {{"world", name},
          {"revisits", c.queries},
          {"strangers", c.strangers},
          {"top1_recall", c.top1_recall()},
          {"recall_at_full_precision", c.recall_at_full_precision()},
          {"verified_recall", c.share(c.verified_right)},
          {"verified_wrong", c.verified_wrong}};
}

/// A recording with ground truth, mapped without closing loops.
Result<Counts> recording_counts(const std::string& sequence, const SeedRequest& request) {
  RunRequest run;
  run.sequence = sequence;
  run.set = request.set;
  run.set.emplace_back("loop.enabled=false");
  run.deterministic = run.quiet = true;
  const Result<ScratchFolder> scratch = ScratchFolder::make();
  if (!scratch) return scratch.error();
  run.out = (scratch->path() / "run").string();
  const Result<RunOutcome> outcome = run_whole_sequence(run);
  if (!outcome) return outcome.error();
  if (!outcome->groundtruth_file) {
    return Error{fmt::format("{}: has no groundtruth.txt", sequence)};
  }
  const Result<StampedPoses> truth = read_tum_trajectory(*outcome->groundtruth_file);
  if (!truth) return truth.error();
  std::vector<Place> places;
  outcome->atlas->keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    const auto next = std::lower_bound(
        truth->begin(), truth->end(), keyframe.stamp,
        [](const StampedPose& pose, Timestamp stamp) { return pose.stamp < stamp; });
    if (next != truth->end()) places.push_back({id, next->T_world_camera});
  });
  Counts counts;
  add_atlas(*outcome->atlas, places, counts);
  return counts;
}

}  // namespace

Result<std::string> bench_places(const SeedRequest& request) {
  std::string table =
      "| world | revisits | other keyframes | best candidate is the place | the same at 100 % "
      "precision | verified | verified but wrong |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  for (const bool look_alike : {false, true}) {
    const std::string name = look_alike ? "simulated, look-alike rooms" : "simulated room";
    Counts counts;
    for (int i = 0; i < request.seeds; ++i) {
      if (auto r = add_walk(request, request.first_seed + i, look_alike, counts); !r) {
        return r.error();
      }
    }
    table += row(name, counts);
    json.push_back(to_json(name, counts));
  }
  for (const std::string& sequence : request.sequences) {
    const Result<Counts> counts = recording_counts(sequence, request);
    if (!counts) return counts.error();
    const std::string name = fs::weakly_canonical(sequence).filename().string();
    table += row(name, *counts);
    json.push_back(to_json(name, *counts));
  }
  return table_and_json(std::move(table), json, request);
}

}  // namespace ydd::app
