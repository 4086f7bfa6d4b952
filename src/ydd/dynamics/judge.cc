// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/judge.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ydd/dynamics/compensation.h"
#include "ydd/dynamics/moving_regions.h"

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
    judgements[region.object].rule = region.rule;
    judgements[region.object].range = region.range;
  }
  for (const Body& body : scene.bodies) {
    ObjectJudgement& person = judgements[body.person];
    person.coincidence = body.coincidence;
    if (body.head >= 0) person.head = scene.objects[body.head].detection;
    for (const int hand : body.hands) person.hands.push_back(scene.objects[hand].detection);
  }
  return judgements;
}

/// Edges and surroundings belong to variant `full`.
PointRuleOptions point_rule_options(const DynamicsOptions& options) {
  PointRuleOptions result;
  if (options.parsed_variant() != Variant::full) return result;
  const RefinementOptions refinement = options.refinement.effective();
  result.edge_radius_px = static_cast<float>(options.edge_radius_px);
  result.surround_px = refinement.surrounded ? refinement.surround_px : 0;
  result.surround_share = refinement.surround_share;
  return result;
}

}  // namespace

int Judgement::rejected() const {
  return static_cast<int>(
      std::count_if(rules.begin(), rules.end(), [](Rule rule) { return rule != Rule::kept; }));
}

Judgement judge_frame(const DynamicsOptions& options, const ObjectCatalogue& catalogue,
                      const Features& features, const Detections& detections,
                      const DepthImage& depth_m) {
  const Scene scene = make_scene(detections, catalogue, depth_m, options);
  const std::vector<MovingRegion> regions = moving_regions(scene, options);
  const PointRuleOptions point_options = point_rule_options(options);
  Judgement judgement;
  judgement.dynamic_frame = true;
  judgement.objects = explain(scene, regions);
  judgement.rules.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    const PointSample point{features.keypoints[i].x_px, features.keypoints[i].y_px,
                            features.depth_m[i]};
    judgement.rules.push_back(rule_of(point, regions, depth_m, point_options));
  }
  return judgement;
}

Observations observe(const Features& features, const Judgement& judgement) {
  if (judgement.rules.size() != features.size()) {
    throw std::logic_error("observe: one rule for each feature is needed");
  }
  Observations observations;
  std::vector<int> kept;
  kept.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (judgement.rules[i] == Rule::kept) {
      kept.push_back(static_cast<int>(i));
    } else {
      observations.rejected.push_back(
          {features.keypoints[i], features.depth_m[i], judgement.rules[i]});
    }
  }
  observations.features = select(features, kept);
  return observations;
}

DynamicsJudge::DynamicsJudge(const DynamicsOptions& options, ObjectCatalogue catalogue)
    : options_(options),
      catalogue_(std::move(catalogue)),
      switch_(options.static_after_frames),
      budget_(options.compensation.points) {}

Judgement DynamicsJudge::judge(const Features& features, const Detections& detections,
                               const DepthImage& depth_m) {
  const bool dynamic_frame = switch_.step(has_dynamic_object(detections, catalogue_));
  Judgement judgement;
  if (dynamic_frame) {
    judgement = judge_frame(options_, catalogue_, features, detections, depth_m);
  } else {
    judgement.rules.assign(features.size(), Rule::kept);
  }
  budget_ = next_budget(static_cast<int>(features.size()), judgement.rejected(), dynamic_frame,
                        options_.compensation);
  return judgement;
}

}  // namespace ydd
