// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/judge.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ydd/dynamics/compensation.h"
#include "ydd/dynamics/connected_things.h"
#include "ydd/dynamics/evidence_rules.h"

namespace ydd {
namespace {

std::vector<ObjectJudgement> explain(const Scene& scene, std::span<const MovingRegion> regions) {
  std::vector<ObjectJudgement> judgements(scene.objects.size());
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    judgements[i].detection = object.detection;
    judgements[i].subcategory = object.subcategory;
    judgements[i].box = object.box;
    judgements[i].depth_m = object.depth_m;
  }
  for (const MovingRegion& region : regions) {
    if (region.object < 0 || region.rule == Rule::connected) continue;  // nothing detected
    judgements[region.object].rule = region.rule;
    judgements[region.object].range = region.range;
    if (region.track >= 0) judgements[region.object].track = region.track;
  }
  for (const Body& body : scene.bodies) {
    ObjectJudgement& person = judgements[body.person];
    person.coincidence = body.coincidence;
    if (body.head >= 0) person.head = scene.objects[body.head].detection;
    for (const int hand : body.hands) person.hands.push_back(scene.objects[hand].detection);
  }
  return judgements;
}

/// Edges and surroundings belong to the whole method.
PointRuleOptions point_rule_options(const DynamicsOptions& options) {
  PointRuleOptions result;
  if (!options.whole()) return result;
  const RefinementOptions& refinement = options.refinement;
  result.edge_radius_px = static_cast<float>(options.edge_radius_px);
  result.unmeasured_edge_px = static_cast<float>(
      options.refinement.enabled ? refinement.unmeasured_edge_px : options.edge_radius_px);
  result.surround_px = refinement.surrounded ? refinement.surround_px : 0;
  result.surround_axes = refinement.surround_axes;
  return result;
}

/// Everything that the rules of the variant find to move, bodies first.
std::vector<MovingRegion> all_regions(const DynamicsOptions& options, const Scene& scene,
                                      std::vector<MovingRegion> bodies) {
  std::vector<MovingRegion> regions = std::move(bodies);
  const auto count = static_cast<std::ptrdiff_t>(regions.size());
  const std::vector<MovingRegion> things = thing_regions(scene, options);
  regions.insert(regions.end(), things.begin(), things.end());
  if (options.whole() && options.refinement.connected) {
    const std::vector<MovingRegion> connected = connected_things(
        scene.depth_m, std::span(regions).first(count), options.refinement.connected_things);
    regions.insert(regions.end(), connected.begin(), connected.end());
  }
  return regions;
}

/// Tells objects their odds, and leaves the regions that do not stand still.
std::vector<MovingRegion> moving_ones(const std::vector<MovingRegion>& regions,
                                      const MotionOdds& odds,
                                      std::vector<ObjectJudgement>& objects) {
  std::vector<MovingRegion> moving;
  for (const MovingRegion& region : regions) {
    const RegionOdds found = region_odds(region, odds);
    const bool still = stands_still(found, region.rule);
    if (!still) moving.push_back(region);
    if (region.object < 0 || region.rule == Rule::connected) continue;
    ObjectJudgement& object = objects[static_cast<std::size_t>(region.object)];
    object.log_odds = found.log_odds + prior_log_odds(region.rule);
    object.seen_to_move = is_seen_to_move(found);
    if (!still) continue;
    object.rule = Rule::kept;
    object.range.reset();
  }
  return moving;
}

/// The rule of a point, by regions alone or (not null) by the odds as well.
Rule point_rule(const PointSample& point, std::span<const MovingRegion> regions,
                const DepthImage& depth_m, const PointRuleOptions& options,
                const MotionOdds* odds) {
  const Rule rule = rule_of(point, regions, depth_m, options);
  if (!odds || rule == Rule::edge) return rule;
  if (rule == Rule::kept) return evidence_rule(point, *odds, depth_m, options.edge_radius_px);
  return stands_still(point, *odds) ? Rule::kept : rule;
}

/// Judges the points of a scene whose bodies (and bodies carried over from earlier frames) are
/// known. `odds` may be null.
Judgement judge_scene(const DynamicsOptions& options, const Scene& scene,
                      std::vector<MovingRegion> bodies, const Features& features,
                      const MotionOdds* odds) {
  std::vector<MovingRegion> regions = all_regions(options, scene, std::move(bodies));
  Judgement judgement;
  judgement.dynamic_frame = true;
  judgement.objects = explain(scene, regions);
  if (odds) regions = moving_ones(regions, *odds, judgement.objects);
  judgement.rules.reserve(features.size());
  const PointRuleOptions point_options = point_rule_options(options);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const PointSample point{features.keypoints[i].x_px, features.keypoints[i].y_px,
                            features.depth_m[i]};
    judgement.rules.push_back(point_rule(point, regions, scene.depth_m, point_options, odds));
  }
  judgement.regions = std::move(regions);
  return judgement;
}

}  // namespace

int Judgement::rejected() const {
  return static_cast<int>(
      std::count_if(rules.begin(), rules.end(), [](Rule rule) { return rule != Rule::kept; }));
}

Judgement judge_frame(const DynamicsOptions& options, const ObjectCatalogue& catalogue,
                      const Features& features, const Detections& detections,
                      const DepthImage& depth_m) {
  const DynamicsOptions resolved = options.resolved();
  const Scene scene = make_scene(detections, catalogue, depth_m, resolved);
  return judge_scene(resolved, scene, body_regions(scene, resolved), features, nullptr);
}

FilteredFeatures filter_features(const Features& features, const Judgement& judgement) {
  if (judgement.rules.size() != features.size()) {
    throw std::logic_error("filter_features: one rule for each feature is needed");
  }
  FilteredFeatures filtered;
  std::vector<int> kept;
  kept.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (judgement.rules[i] == Rule::kept) {
      kept.push_back(static_cast<int>(i));
    } else {
      filtered.rejected.push_back({features.keypoints[i], features.depth_m[i], judgement.rules[i]});
    }
  }
  filtered.kept = std::make_shared<const Features>(select(features, kept));
  return filtered;
}

DynamicsJudge::DynamicsJudge(const DynamicsOptions& options, ObjectCatalogue catalogue)
    : options_(options.resolved()),
      catalogue_(std::move(catalogue)),
      switch_(options.static_after_frames),
      budget_(options.compensation.points) {}

void DynamicsJudge::set_variant(Variant variant) {
  options_.variant = variant;
  tracks_.clear();
}

Judgement DynamicsJudge::judge(const Features& features, const Detections& detections,
                               const DepthImage& depth_m, const MotionOdds* odds) {
  if (options_.variant != Variant::evidence) odds = nullptr;
  const bool dynamic_object = switch_.step(has_dynamic_object(detections, catalogue_));
  const bool dynamic_frame = dynamic_object || odds;
  Judgement judgement;
  if (dynamic_frame) {
    const Scene scene = make_scene(detections, catalogue_, depth_m, options_);
    judgement = judge_scene(options_, scene, persons_of(scene), features, odds);
  } else {
    tracks_.clear();
    judgement.rules.assign(features.size(), Rule::kept);
  }
  budget_ = next_budget(static_cast<int>(features.size()), judgement.rejected(), dynamic_frame,
                        options_.compensation);
  return judgement;
}

std::vector<MovingRegion> DynamicsJudge::persons_of(const Scene& scene) {
  std::vector<MovingRegion> persons = body_regions(scene, options_);
  if (!options_.whole() || !options_.refinement.bridging) return persons;
  const std::vector<MovingRegion> missed = tracks_.follow(
      persons, scene.depth_m.width(), scene.depth_m.height(), options_.refinement.bridge);
  persons.insert(persons.end(), missed.begin(), missed.end());
  return persons;
}

}  // namespace ydd
