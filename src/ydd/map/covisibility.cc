// SPDX-License-Identifier: Apache-2.0
// The graph parts of Atlas: who shares points with whom, and the spanning tree.
#include <algorithm>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "ydd/map/atlas.h"

namespace ydd {
namespace {

void sort_heaviest_first(std::vector<Covisible>& list, const Table<KeyFrame, KeyFrameTag>& table) {
  std::sort(list.begin(), list.end(), [&](const Covisible& a, const Covisible& b) {
    if (a.weight != b.weight) return a.weight > b.weight;
    return table.at(a.keyframe).serial < table.at(b.keyframe).serial;
  });
}

std::vector<Covisible> shared_points(const Atlas& atlas, KeyFrameId id) {
  std::map<KeyFrameId, int> counts;
  for (const MapPointId point : atlas.at(id).points) {
    if (!point.valid()) continue;
    for (const Observation& s : atlas.at(point).observations) {
      if (s.keyframe != id) ++counts[s.keyframe];
    }
  }
  std::vector<Covisible> list;
  list.reserve(counts.size());
  for (const auto& [keyframe, weight] : counts) list.push_back({keyframe, weight});
  sort_heaviest_first(list, atlas.keyframes());
  return list;
}

}  // namespace

void Atlas::connect(KeyFrameId from, KeyFrameId to, int weight) {
  std::vector<Covisible>& list = keyframes_.edit(from).covisible;
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Covisible& c) { return c.keyframe == to; });
  if (found == list.end()) {
    list.push_back({to, weight});
  } else {
    found->weight = weight;
  }
  sort_heaviest_first(list, keyframes_);
}

void Atlas::drop_connections(KeyFrameId id) {
  for (const Covisible& c : keyframes_.at(id).covisible) {
    std::erase_if(keyframes_.edit(c.keyframe).covisible,
                  [&](const Covisible& back) { return back.keyframe == id; });
  }
  keyframes_.edit(id).covisible.clear();
}

void Atlas::refresh_covisibility(KeyFrameId id, int min_weight) {
  ++revision_;
  std::vector<Covisible> list = shared_points(*this, id);
  const auto weak = std::find_if(list.begin(), list.end(),
                                 [&](const Covisible& c) { return c.weight < min_weight; });
  const auto keep = static_cast<std::size_t>(weak - list.begin());
  if (list.size() > 1) list.resize(std::max<std::size_t>(keep, 1));
  drop_connections(id);
  for (const Covisible& c : list) connect(c.keyframe, id, c.weight);
  const KeyFrameId strongest = list.empty() ? KeyFrameId{} : list.front().keyframe;
  keyframes_.edit(id).covisible = std::move(list);
  if (!at(id).parent.valid() && !is_first(id)) link_parent(id, strongest);
}

bool Atlas::is_first(KeyFrameId id) const {
  const KeyFrame& keyframe = keyframes_.at(id);
  if (keyframe.parent.valid()) return false;
  bool first = true;
  keyframes_.for_each([&](KeyFrameId, const KeyFrame& other) {
    first = first && (other.map != keyframe.map || other.serial >= keyframe.serial);
  });
  return first;
}

void Atlas::link_parent(KeyFrameId id, KeyFrameId parent) {
  const KeyFrameId before = at(id).parent;
  if (before == parent) return;
  if (find(before)) std::erase(keyframes_.edit(before).children, id);
  keyframes_.edit(id).parent = parent;
  if (!find(parent)) return;
  std::vector<KeyFrameId>& children = keyframes_.edit(parent).children;
  children.insert(std::upper_bound(children.begin(), children.end(), id), id);
}

KeyFrameId Atlas::best_new_parent(KeyFrameId child, const std::vector<KeyFrameId>& orphans) const {
  // An orphan under an orphan could close a ring; only keyframes outside the orphaned sub-trees
  // are safe, that is those whose chain of parents does not end in one of them.
  const auto leads_to_orphan = [&](KeyFrameId id) {
    for (const KeyFrame* k = find(id); k; id = k->parent, k = find(id)) {
      if (std::find(orphans.begin(), orphans.end(), id) != orphans.end()) return true;
    }
    return false;
  };
  for (const Covisible& c : at(child).covisible) {
    if (!leads_to_orphan(c.keyframe)) return c.keyframe;
  }
  return {};
}

void Atlas::adopt_children(KeyFrameId culled) {
  const KeyFrameId grandparent = at(culled).parent;
  std::vector<KeyFrameId> orphans = at(culled).children;
  for (const KeyFrameId child : orphans) link_parent(child, {});
  bool progress = true;
  while (progress && !orphans.empty()) {
    progress = false;
    for (std::size_t i = 0; i < orphans.size(); ++i) {
      const KeyFrameId parent = best_new_parent(orphans[i], orphans);
      if (!parent.valid()) continue;
      link_parent(orphans[i], parent);
      orphans.erase(orphans.begin() + static_cast<std::ptrdiff_t>(i));
      progress = true;
      break;
    }
  }
  for (const KeyFrameId child : orphans) link_parent(child, grandparent);
}

void Atlas::cull_keyframe(KeyFrameId id) {
  if (is_first(id)) throw std::logic_error("Atlas: the first keyframe of a map cannot be culled");
  ++revision_;
  const std::vector<MapPointId> points = at(id).points;
  for (const MapPointId point : points) {
    if (point.valid()) remove_observation(point, id);
  }
  drop_connections(id);
  adopt_children(id);
  const KeyFrame& keyframe = at(id);
  culled_.add(id, {keyframe.parent,
                   at(keyframe.parent).T_world_camera.inverse() * keyframe.T_world_camera});
  if (keyframe.words) word_index_.remove(keyframe.serial, id);
  link_parent(id, {});
  keyframes_.erase(id);
  if (id == newest_) newest_ = youngest();
}

void Atlas::reroot(KeyFrameId root, KeyFrameId parent) {
  ++revision_;
  for (KeyFrameId id = root; id.valid();) {
    const KeyFrameId above = at(id).parent;
    link_parent(id, parent);
    parent = id;
    id = above;
  }
}

KeyFrameId Atlas::youngest() const {
  KeyFrameId youngest;
  std::int64_t serial = -1;
  keyframes_.for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.serial <= serial) return;
    serial = keyframe.serial;
    youngest = id;
  });
  return youngest;
}

void Atlas::check_tree(std::vector<std::string>& faults) const {
  enum class Walk : std::uint8_t { unknown, under_way, done };
  std::vector<Walk> walks(keyframes_.slots(), Walk::unknown);
  std::size_t linked = 0, with_parent = 0;
  keyframes_.for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (!keyframe.parent.valid() ? !is_first(id) : !find(keyframe.parent)) {
      faults.push_back(fmt::format("keyframe {}: no parent", id.slot));
    }
    const auto& children = keyframe.children;
    const bool mutual = std::all_of(children.begin(), children.end(), [&](KeyFrameId child) {
      return find(child) && at(child).parent == id;
    });
    linked += children.size();
    if (!mutual || !std::is_sorted(children.begin(), children.end())) {
      faults.push_back(fmt::format("keyframe {}: children of another parent", id.slot));
    }
    with_parent += find(keyframe.parent) ? 1 : 0;
    // Up to what is known already: every keyframe is walked over once.
    std::vector<KeyFrameId> way;
    while (find(id) && walks[id.slot] == Walk::unknown) {
      walks[id.slot] = Walk::under_way;
      way.push_back(id);
      id = at(id).parent;
    }
    if (find(id) && walks[id.slot] == Walk::under_way) {
      faults.push_back(fmt::format("keyframe {}: ring of parents", id.slot));
    }
    for (const KeyFrameId walked : way) walks[walked.slot] = Walk::done;
  });
  if (linked != with_parent) faults.emplace_back("a keyframe that its parent does not know");
}

void Atlas::check_words(std::vector<std::string>& faults) const {
  std::size_t with_words = 0;
  keyframes_.for_each([&](KeyFrameId, const KeyFrame& k) { with_words += k.words ? 1 : 0; });
  const std::vector<WordIndex::Entry> entries = word_index_.entries();
  const bool all =
      with_words == entries.size() && word_index_.size() == entries.size() &&
      std::all_of(entries.begin(), entries.end(), [&](const auto& entry) {
        const KeyFrame* keyframe = find(entry.keyframe);
        return keyframe && keyframe->words == entry.words && keyframe->serial == entry.serial;
      });
  if (!all) faults.emplace_back("the index of words is not of these keyframes");
}

std::vector<std::string> Atlas::check_consistency() const {
  std::vector<std::string> faults;
  points_.for_each([&](MapPointId id, const MapPoint& point) {
    if (point.observations.empty())
      faults.push_back(fmt::format("point {}: no observation", id.slot));
    for (const Observation& s : point.observations) {
      const KeyFrame* keyframe = find(s.keyframe);
      if (!keyframe || keyframe->points.at(static_cast<std::size_t>(s.keypoint)) != id) {
        faults.push_back(fmt::format("point {}: observation without link back", id.slot));
      }
    }
  });
  keyframes_.for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.points.size() != keyframe.features().size()) {
      faults.push_back(fmt::format("keyframe {}: point list of another length", id.slot));
    }
    for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
      if (!keyframe.points[i].valid()) continue;
      const MapPoint* point = find(keyframe.points[i]);
      const Observation link{id, static_cast<int>(i)};
      if (!point || std::find(point->observations.begin(), point->observations.end(), link) ==
                        point->observations.end()) {
        faults.push_back(fmt::format("keyframe {}: keypoint {} without link back", id.slot, i));
      }
    }
    for (const Covisible& c : keyframe.covisible) {
      const KeyFrame* other = find(c.keyframe);
      const Covisible back{id, c.weight};
      if (!other || std::find(other->covisible.begin(), other->covisible.end(), back) ==
                        other->covisible.end()) {
        faults.push_back(fmt::format("keyframe {}: one-sided covisibility", id.slot));
      }
    }
  });
  check_tree(faults);
  check_words(faults);
  return faults;
}

}  // namespace ydd
