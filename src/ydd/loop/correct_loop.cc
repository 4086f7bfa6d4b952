// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ydd/loop/loop_closer.h"

namespace ydd {
namespace {

std::vector<KeyFrameId> keyframes_of(const Atlas& atlas, MapId map) {
  std::vector<KeyFrameId> out;
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.map == map) out.push_back(id);
  });
  return out;
}

/// Nodes are the keyframes of one map; edges keep what they measured of each other.
class EssentialGraph {
 public:
  EssentialGraph(const Atlas& atlas, const std::vector<KeyFrameId>& keyframes)
      : atlas_(atlas), keyframes_(keyframes), index_(atlas.keyframes().slots(), -1) {
    for (const KeyFrameId id : keyframes_) {
      index_[id.slot] = static_cast<int>(graph_.nodes.size());
      graph_.nodes.push_back({atlas.at(id).T_world_camera, false});
    }
  }

  void add_edge(KeyFrameId from, KeyFrameId to, const SE3& T_from_to) {
    if (!atlas_.find(from) || !atlas_.find(to) || index_[from.slot] < 0 || index_[to.slot] < 0) {
      return;
    }
    graph_.edges.push_back({index_[from.slot], index_[to.slot], T_from_to});
  }
  /// An edge that holds what the map says now.
  void keep(KeyFrameId from, KeyFrameId to) {
    if (!atlas_.find(from) || !atlas_.find(to)) return;
    add_edge(from, to, atlas_.at(from).T_world_camera.inverse() * atlas_.at(to).T_world_camera);
  }
  void fix(KeyFrameId id) { graph_.nodes[static_cast<std::size_t>(index_[id.slot])].fixed = true; }
  const PoseGraph& graph() const { return graph_; }

 private:
  const Atlas& atlas_;
  const std::vector<KeyFrameId>& keyframes_;
  std::vector<int> index_;
  PoseGraph graph_;
};

/// Moves the younger map, whichever of the two was seen again: the world of a map that somebody
/// saved or counts on must not move because a newcomer met it.
Correction merge(const Atlas& atlas, const LoopMatch& match) {
  const SE3 T_matched_current =
      match.T_world_current * atlas.at(match.current).T_world_camera.inverse();
  const bool current_is_younger = atlas.at(match.matched).map < atlas.at(match.current).map;
  const KeyFrameId moving = current_is_younger ? match.current : match.matched;
  const KeyFrameId staying = current_is_younger ? match.matched : match.current;
  const SE3 T_new_old = current_is_younger ? T_matched_current : T_matched_current.inverse();
  Correction correction;
  correction.revision = atlas.revision();
  for (const KeyFrameId id : keyframes_of(atlas, atlas.at(moving).map)) {
    correction.T_world_keyframe[id] = T_new_old * atlas.at(id).T_world_camera;
  }
  correction.junction = Correction::Junction{moving, staying};
  return correction;
}

}  // namespace

std::optional<Correction> correct_loop(const Atlas& atlas, const LoopMatch& match,
                                       const LoopOptions& options, const std::stop_token& stop) {
  if (atlas.at(match.current).map != atlas.at(match.matched).map) return merge(atlas, match);
  const std::vector<KeyFrameId> keyframes = keyframes_of(atlas, atlas.at(match.current).map);
  EssentialGraph essential(atlas, keyframes);
  for (const KeyFrameId id : keyframes) {
    const KeyFrame& keyframe = atlas.at(id);
    essential.keep(keyframe.parent, id);
    for (const Covisible& c : keyframe.covisible) {
      if (c.weight < options.essential_weight) break;
      if (c.keyframe < id && c.keyframe != keyframe.parent) essential.keep(c.keyframe, id);
    }
    for (const KeyFrameId loop : keyframe.loops) essential.keep(loop, id);
    if (atlas.is_first(id)) essential.fix(id);
  }
  essential.add_edge(match.matched, match.current,
                     atlas.at(match.matched).T_world_camera.inverse() * match.T_world_current);
  const PoseGraphResult solved = solve_pose_graph(essential.graph(), options.graph, stop);
  if (solved.interrupted) return std::nullopt;
  Correction correction;
  correction.revision = atlas.revision();
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    correction.T_world_keyframe[keyframes[i]] = solved.T_world_node[i];
  }
  correction.junction = Correction::Junction{match.current, match.matched};
  return correction;
}

}  // namespace ydd
