// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>

#include "ydd/loop/keyframe_groups.h"
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

/// Nodes are the keyframes of one map, or groups of them; edges keep what they measured of each
/// other.
class EssentialGraph {
 public:
  EssentialGraph(const Atlas& atlas, const std::vector<KeyFrameId>& keyframes,
                 const KeyFrameGroups& groups)
      : atlas_(atlas),
        groups_(groups),
        grouped_(groups.leader.size() < keyframes.size()),
        group_(atlas.keyframes().slots(), -1),
        steps_(atlas.keyframes().slots(), 0) {
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      group_[keyframes[i].slot] = groups.group_of[i];
      steps_[keyframes[i].slot] = groups.steps[i];
    }
    for (const KeyFrameId leader : groups.leader) {
      graph_.nodes.push_back({atlas.at(leader).T_world_camera, false});
    }
  }

  /// An edge that holds what was measured.
  void add_edge(KeyFrameId from, KeyFrameId to, const SE3& T_from_to) {
    if (!has(from) || !has(to) || group_[from.slot] == group_[to.slot]) return;
    graph_.edges.push_back(
        {group_[from.slot], group_[to.slot], T_leader(from) * T_from_to * T_leader(to).inverse()});
  }
  /// An edge that holds what the map says now.
  void keep(KeyFrameId from, KeyFrameId to) {
    if (!has(from) || !has(to)) return;
    if (grouped_) {
      // All edges between two groups say the same. Within a group nothing gives way: what the
      // edges on the way from leader to leader would give, the one between them must give.
      kept_[{group_[from.slot], group_[to.slot]}] +=
          1.0 / (steps_[from.slot] + 1 + steps_[to.slot]);
    } else {
      add_edge(from, to, atlas_.at(from).T_world_camera.inverse() * atlas_.at(to).T_world_camera);
    }
  }
  void fix(KeyFrameId id) { graph_.nodes[static_cast<std::size_t>(group_[id.slot])].fixed = true; }

  const PoseGraph& finish() {
    for (const auto& [groups, weight] : kept_) {
      const auto& [from, to] = groups;
      if (from == to) continue;
      const SE3 T_from_to = node(from).T_world_node.inverse() * node(to).T_world_node;
      graph_.edges.push_back({from, to, T_from_to, weight * Matrix6d::Identity()});
    }
    return graph_;
  }

  /// Where the keyframe stands once its group stands there.
  SE3 T_world_keyframe(KeyFrameId id, const std::vector<SE3>& T_world_node) const {
    return T_world_node[static_cast<std::size_t>(group_[id.slot])] * T_leader(id);
  }

 private:
  bool has(KeyFrameId id) const { return atlas_.find(id) && group_[id.slot] >= 0; }
  const PoseGraph::Node& node(int i) const { return graph_.nodes[static_cast<std::size_t>(i)]; }
  /// The keyframe in the frame of its leader, the identity to the bit for the leader itself.
  SE3 T_leader(KeyFrameId id) const {
    const KeyFrameId leader = groups_.leader[static_cast<std::size_t>(group_[id.slot])];
    if (leader == id) return {};
    return atlas_.at(leader).T_world_camera.inverse() * atlas_.at(id).T_world_camera;
  }

  const Atlas& atlas_;
  const KeyFrameGroups& groups_;
  bool grouped_;
  std::vector<int> group_;  ///< by slot; -1: of another map
  std::vector<int> steps_;  ///< by slot, to the leader
  std::map<std::pair<int, int>, double> kept_;
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
  correction.newcomers_from = atlas.next_serial();
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
  const KeyFrameId ends[] = {match.current, match.matched};
  const KeyFrameGroups groups =
      group_keyframes(atlas, keyframes, static_cast<std::size_t>(options.graph_nodes), ends);
  EssentialGraph essential(atlas, keyframes, groups);
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
  const PoseGraphResult solved = solve_pose_graph(essential.finish(), options.graph, stop);
  if (solved.interrupted) return std::nullopt;
  Correction correction;
  correction.revision = atlas.revision();
  correction.newcomers_from = atlas.next_serial();
  for (const KeyFrameId id : keyframes) {
    correction.T_world_keyframe[id] = essential.T_world_keyframe(id, solved.T_world_node);
  }
  correction.junction = Correction::Junction{match.current, match.matched};
  return correction;
}

}  // namespace ydd
