// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/moving_regions.h"

#include <algorithm>

#include "ydd/dynamics/box_geometry.h"
#include "ydd/dynamics/hidden_bodies.h"
#include "ydd/dynamics/moved_objects.h"

namespace ydd {
namespace {

bool is_small(const Scene& scene, const Box& box, const DynamicsOptions& options) {
  const double image_area = static_cast<double>(scene.depth_m.width()) * scene.depth_m.height();
  return box.area() < options.small_box_share * image_area;
}

MovingRegion region_of(const Scene& scene, int object, Rule rule,
                       std::optional<DepthRange> range = std::nullopt) {
  return {.object = object,
          .rule = rule,
          .box = scene.objects[object].box,
          .range = range,
          .mask = scene.objects[object].mask};
}

/// Calls `visit(index)` for all objects of that category or kind.
template <class Which, class Visit>
void for_objects(const Scene& scene, Which&& which, Visit&& visit) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (which(scene.objects[i].subcategory)) visit(static_cast<int>(i));
  }
}

bool is_hand(Subcategory subcategory) { return subcategory == Subcategory::hand; }
bool is_automatic(Subcategory subcategory) { return subcategory == Subcategory::automatic; }
bool is_potential(Subcategory subcategory) {
  return category_of(subcategory) == Category::potentially_dynamic;
}

/// The hands that may move an object: the matched ones, with `any_hand` all.
std::vector<int> moving_hands(const Scene& scene, const DynamicsOptions& options) {
  std::vector<int> hands;
  if (options.refinement.any_hand) {
    for_objects(scene, is_hand, [&](int i) { hands.push_back(i); });
    return hands;
  }
  for (const Body& body : scene.bodies) {
    hands.insert(hands.end(), body.hands.begin(), body.hands.end());
  }
  return hands;
}

/// Whether the depth of an object is asked for: a hand's box meets it, or (`near_bodies`) the box
/// of a body whose hands are hidden.
bool may_be_moved(const Scene& scene, const SceneObject& thing, bool near_bodies,
                  const DynamicsOptions& options) {
  const std::vector<int> hands = moving_hands(scene, options);
  return std::any_of(hands.begin(), hands.end(),
                     [&](int hand) { return intersect(scene.objects[hand].box, thing.box); }) ||
         (near_bodies &&
          std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) {
            return may_move_with(scene.objects, body, thing, options.matching.hands);
          }));
}

/// Heads and hands whose box meets no person box.
std::vector<int> lone_parts(const Scene& scene) {
  std::vector<int> parts;
  for_objects(
      scene, [](Subcategory s) { return s == Subcategory::head || s == Subcategory::hand; },
      [&](int i) {
        const bool lone =
            std::all_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) {
              return disjoint(scene.objects[body.person].box, scene.objects[i].box);
            });
        if (lone) parts.push_back(i);
      });
  return parts;
}

/// Of overlapping persons the nearer one gives the measured depth of both boxes. Where no head
/// tells the farther one apart, what the others leave of its box does.
std::vector<MovingRegion> with_hidden_bodies(const Scene& scene, const DynamicsOptions& options,
                                             std::vector<MovingRegion> regions) {
  const RefinementOptions& refinement = options.refinement;
  if (!refinement.hidden_bodies) return regions;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const Body& body = scene.bodies[i];
    const bool headless = body.head < 0 || !scene.objects[body.head].depth_m;
    const bool by_depth = regions[i].rule == Rule::body_depth;
    if (body.coincidence <= 0.0F || !headless ||
        (!by_depth && regions[i].rule != Rule::full_entangled)) {
      continue;
    }
    const auto rest_m = unexplained_depth(scene.depth_m, i, regions, refinement.rest_share);
    if (!rest_m) continue;
    const DepthRange rest = person_range(*rest_m, scene.extents, options.front_allowance);
    regions[i].range = by_depth ? joined(*regions[i].range, rest) : rest;
    regions[i].rule = Rule::body_depth;
  }
  return regions;
}

}  // namespace

Scene make_scene(const Detections& detections, const ObjectCatalogue& catalogue,
                 const DepthImage& depth_m, const DynamicsOptions& options) {
  Scene scene;
  const RefinementOptions& refinement = options.refinement;
  const bool full = options.whole();
  scene.objects = measure_objects(detections, catalogue, depth_m, options.object_depth,
                                  full && refinement.uncovered_heads);
  scene.bodies = match_bodies(scene.objects, options.matching, full && refinement.own_heads);
  scene.extents = catalogue.extents();
  scene.depth_m = depth_m;
  return scene;
}

MovingRegion person_region(const Scene& scene, const Body& body, const DynamicsOptions& options) {
  const auto range =
      body_range(depths_of(body, scene.objects), scene.extents, options.front_allowance);
  return region_of(scene, body.person, range ? Rule::body_depth : Rule::full_depth_failed, range);
}

MovingRegion body_region(const Scene& scene, const Body& body, const DynamicsOptions& options) {
  if (is_small(scene, scene.objects[body.person].box, options)) {
    return region_of(scene, body.person, Rule::full_small_box);
  }
  // Of two entangled persons the nearer one gives the measured depth of both boxes; a head of its
  // own tells the farther one apart.
  const bool by_head =
      options.refinement.entangled_by_head && body.head >= 0 && scene.objects[body.head].depth_m;
  if (body.entangled && !by_head) return region_of(scene, body.person, Rule::full_entangled);
  return person_region(scene, body, options);
}

MovingRegion automatic_region(const Scene& scene, int object, const DynamicsOptions& options) {
  const SceneObject& thing = scene.objects[object];
  if (is_small(scene, thing.box, options)) return region_of(scene, object, Rule::full_small_box);
  if (!thing.depth_m) return region_of(scene, object, Rule::full_depth_failed);
  return region_of(scene, object, Rule::automatic_depth,
                   object_range(*thing.depth_m, thing.extent_m, options.front_allowance));
}

std::optional<MovingRegion> moved_region(const Scene& scene, int object,
                                         const DynamicsOptions& options) {
  const SceneObject& thing = scene.objects[object];
  if (!thing.depth_m) {
    const bool spare = options.refinement.spare_unmeasured;
    if (!may_be_moved(scene, thing, !spare, options)) return std::nullopt;
    return region_of(scene, object, Rule::full_depth_failed);
  }
  const DepthRange thing_range =
      object_range(*thing.depth_m, thing.extent_m, options.front_allowance);
  for (const int hand : moving_hands(scene, options)) {
    if (moved_by_hand(scene.depth_m, scene.objects[hand], thing, options.front_allowance,
                      options.moved)) {
      return region_of(scene, object, Rule::moved_by_hand, thing_range);
    }
  }
  for (const Body& body : scene.bodies) {
    const auto range =
        body_range(depths_of(body, scene.objects), scene.extents, options.front_allowance);
    if (range && moved_near_body(scene.objects, body, *range, thing, options.matching.hands)) {
      return region_of(scene, object, Rule::moved_near_body, thing_range);
    }
  }
  return std::nullopt;
}

MovingRegion hand_region(const Scene& scene, int object, const DynamicsOptions& options) {
  const SceneObject& hand = scene.objects[object];
  if (!hand.depth_m) return region_of(scene, object, Rule::full_depth_failed);
  const double centre_m = *hand.depth_m + hand.extent_m / 2;
  MovingRegion region = region_of(scene, object, Rule::around_hand,
                                  DepthRange{static_cast<float>(centre_m - scene.extents.small_m),
                                             static_cast<float>(centre_m + scene.extents.small_m)});
  region.box = scaled(region.box, static_cast<float>(options.hand_scale));
  region.mask = {};  // what the hand holds is not on it
  return region;
}

MovingRegion lone_part_region(const Scene& scene, int object, const DynamicsOptions& options) {
  const SceneObject& part = scene.objects[object];
  if (!part.depth_m) return region_of(scene, object, Rule::full_depth_failed);
  return region_of(scene, object, Rule::lone_part,
                   object_range(*part.depth_m, part.extent_m, options.front_allowance));
}

std::vector<MovingRegion> body_regions(const Scene& scene, const DynamicsOptions& options) {
  const Variant variant = options.variant;
  std::vector<MovingRegion> regions;
  if (variant == Variant::off) return regions;
  for (const Body& body : scene.bodies) {
    if (variant == Variant::box) regions.push_back(region_of(scene, body.person, Rule::box));
    if (variant == Variant::person) regions.push_back(person_region(scene, body, options));
    if (options.whole()) regions.push_back(body_region(scene, body, options));
  }
  return options.whole() ? with_hidden_bodies(scene, options, std::move(regions)) : regions;
}

std::vector<MovingRegion> thing_regions(const Scene& scene, const DynamicsOptions& options) {
  std::vector<MovingRegion> regions;
  if (!options.whole()) return regions;
  for_objects(scene, is_automatic,
              [&](int i) { regions.push_back(automatic_region(scene, i, options)); });
  for_objects(scene, is_potential, [&](int i) {
    if (auto region = moved_region(scene, i, options)) regions.push_back(*region);
  });
  if (options.refinement.lone_parts) {
    for (const int i : lone_parts(scene)) regions.push_back(lone_part_region(scene, i, options));
  }
  for_objects(scene, is_hand, [&](int i) { regions.push_back(hand_region(scene, i, options)); });
  return regions;
}

}  // namespace ydd
