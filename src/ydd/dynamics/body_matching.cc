// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/body_matching.h"

#include <algorithm>
#include <cmath>

#include "ydd/dynamics/box_geometry.h"

namespace ydd {
namespace {

std::vector<int> indices_of(std::span<const SceneObject> objects, Subcategory subcategory) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].subcategory == subcategory) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

/// Objects of that kind whose box meets the box of `object`.
std::vector<int> meeting_of(std::span<const SceneObject> objects, Subcategory kind, int object) {
  std::vector<int> indices = indices_of(objects, kind);
  std::erase_if(indices, [&](int i) { return disjoint(objects[i].box, objects[object].box); });
  return indices;
}

/// Share of a head box that must lie in the box of its owner.
constexpr float kMostlyInside = 0.7F;

bool in_upper_part(const Box& head, const Box& person, double upper_share) {
  if (person.width() >= person.height()) return true;  // lying or cut off: no upper part to ask for
  return (head.y0 + head.y1) / 2 <= person.y0 + upper_share * person.height();
}

bool near_in_depth(std::optional<float> a, std::optional<float> b, double limit_m) {
  return a && b && std::abs(*a - *b) < limit_m;
}

}  // namespace

std::vector<int> owners_of_heads(std::span<const SceneObject> objects,
                                 const BodyMatchingOptions& options) {
  struct Pair {
    float distance;  // between the top borders, in head heights
    int head, person;
  };
  std::vector<Pair> pairs;
  for (const int head : indices_of(objects, Subcategory::head)) {
    const Box& box = objects[head].box;
    for (const int person : meeting_of(objects, Subcategory::person, head)) {
      const Box& whole = objects[person].box;
      if (coincidence_degree(box, whole) < kMostlyInside ||
          !in_upper_part(box, whole, options.head_upper_share)) {
        continue;
      }
      const float distance = std::abs(box.y0 - whole.y0) / std::max(1.0F, box.height());
      if (distance < 1.0F) pairs.push_back({distance, head, person});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<int> owners(objects.size(), -1);
  std::vector<bool> has_head(objects.size(), false);
  for (const Pair& pair : pairs) {
    if (owners[pair.head] >= 0 || has_head[pair.person]) continue;
    owners[pair.head] = pair.person;
    has_head[pair.person] = true;
  }
  return owners;
}

int match_head(std::span<const SceneObject> objects, int person, std::vector<int> heads,
               const BodyMatchingOptions& options) {
  if (heads.size() <= 1) return heads.empty() ? -1 : heads.front();
  const SceneObject& whole = objects[person];
  std::erase_if(heads, [&](int i) {
    return !in_upper_part(objects[i].box, whole.box, options.head_upper_share) ||
           !near_in_depth(objects[i].depth_m, whole.depth_m, options.head_depth_m);
  });
  const auto top_distance = [&](int i) { return std::abs(objects[i].box.y0 - whole.box.y0); };
  const auto best = std::min_element(
      heads.begin(), heads.end(), [&](int a, int b) { return top_distance(a) < top_distance(b); });
  return best == heads.end() ? -1 : *best;
}

std::vector<int> match_hands(std::span<const SceneObject> objects, int person, int head,
                             std::vector<int> hands, const BodyMatchingOptions& options) {
  const auto most = static_cast<std::size_t>(options.hands);
  if (hands.size() <= most) return hands;
  const bool head_depth = head >= 0 && objects[head].depth_m;
  const std::optional<float> reference = objects[head_depth ? head : person].depth_m;
  std::erase_if(hands, [&](int i) {
    return !near_in_depth(objects[i].depth_m, reference, options.hand_depth_m);
  });
  std::stable_sort(hands.begin(), hands.end(), [&](int a, int b) {
    return std::abs(*objects[a].depth_m - *reference) < std::abs(*objects[b].depth_m - *reference);
  });
  hands.resize(std::min(hands.size(), most));
  return hands;
}

namespace {

/// The head of a person that overlaps another, when owners are known: its own, else by the
/// article's rules among those that belong to nobody (not when it is entangled).
int head_by_owner(std::span<const SceneObject> objects, const Body& body,
                  std::span<const int> owners, const BodyMatchingOptions& options) {
  const auto own = std::find(owners.begin(), owners.end(), body.person);
  if (own != owners.end()) return static_cast<int>(own - owners.begin());
  if (body.entangled) return -1;
  std::vector<int> heads = meeting_of(objects, Subcategory::head, body.person);
  std::erase_if(heads, [&](int i) { return owners[i] >= 0; });
  return match_head(objects, body.person, std::move(heads), options);
}

}  // namespace

std::vector<Body> match_bodies(std::span<const SceneObject> objects,
                               const BodyMatchingOptions& options, bool own_heads) {
  const std::vector<int> persons = indices_of(objects, Subcategory::person);
  std::vector<Box> boxes;
  boxes.reserve(persons.size());
  for (const int i : persons) boxes.push_back(objects[i].box);
  const std::vector<float> degrees = largest_coincidence(boxes);
  const std::vector<int> owners =
      own_heads ? owners_of_heads(objects, options) : std::vector<int>();
  std::vector<Body> bodies;
  bodies.reserve(persons.size());
  for (std::size_t k = 0; k < persons.size(); ++k) {
    Body body;
    body.person = persons[k];
    body.coincidence = degrees[k];
    body.entangled = degrees[k] > options.entangled_degree;
    if (own_heads && degrees[k] > 0.0F) {
      body.head = head_by_owner(objects, body, owners, options);
    } else if (!body.entangled) {
      body.head = match_head(objects, body.person,
                             meeting_of(objects, Subcategory::head, body.person), options);
    }
    if (degrees[k] == 0.0F) {
      body.hands = match_hands(objects, body.person, body.head,
                               meeting_of(objects, Subcategory::hand, body.person), options);
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

BodyDepths depths_of(const Body& body, std::span<const SceneObject> objects) {
  BodyDepths depths;
  depths.person_m = objects[body.person].depth_m;
  if (body.head >= 0) depths.head_m = objects[body.head].depth_m;
  for (const int i : body.hands) {
    const std::optional<float> d = objects[i].depth_m;
    if (!d) continue;
    depths.nearest_hand_m = std::min(depths.nearest_hand_m.value_or(*d), *d);
    depths.farthest_hand_m = std::max(depths.farthest_hand_m.value_or(*d), *d);
  }
  return depths;
}

}  // namespace ydd
