// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/place_recall.h"

#include "ydd/place/place_query.h"

namespace ydd {
namespace {

// What counts as the same place: so near in space and direction that the pictures share things.
constexpr double kNear_m = 0.6;
constexpr double kNear_rad = 0.35;
constexpr std::size_t kCandidates = 5;
constexpr std::size_t kPerPlace = 6;
constexpr double kRight_m = 0.10;  // of a verified pose
constexpr double kRight_rad = 0.05;

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
         const LoopOptions& options, double apart_s, PlaceCounts& counts) {
  const KeyFrame& keyframe = atlas.at(query.id);
  const auto past = [&](KeyFrameId id) {
    return seconds_between(atlas.at(id).stamp, keyframe.stamp) > apart_s;
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

}  // namespace

void count_places(const Atlas& atlas, const std::vector<Place>& places, const LoopOptions& options,
                  PlaceCounts& counts, double apart_s) {
  for (const Place& query : places) ask(atlas, query, places, options, apart_s, counts);
}

}  // namespace ydd
