// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/table.h"
#include "ydd/geometry/camera.h"
#include "ydd/map/culled_keyframes.h"
#include "ydd/map/map_types.h"
#include "ydd/map/word_index.h"

namespace ydd {

/// Everything that an atlas consists of, as data: how a stored one comes back.
struct AtlasParts {
  Camera camera;                                           ///< that all keyframes were taken with
  PyramidScales scales;                                    ///< of the extractor's pyramid
  std::vector<std::pair<KeyFrameId, KeyFrame>> keyframes;  ///< each with its id
  std::vector<KeyFrameId> freed_keyframes;                 ///< as Table::freed
  std::vector<std::pair<MapPointId, MapPoint>> points;     ///< each with its id
  std::vector<MapPointId> freed_points;                    ///< as Table::freed
  std::map<KeyFrameId, CulledKeyFrame> culled;  ///< where keyframes stood that are no longer kept
  std::uint64_t revision = 0;                   ///< as Atlas::revision
  KeyFrameId newest;                            ///< as Atlas::newest_keyframe
  std::int64_t next_serial = 0;                 ///< as Atlas::next_serial
  std::uint32_t maps = 0;                       ///< as Atlas::maps
};

/// Where a keyframe stands that is not in memory.
struct FarKeyFrame {
  MapId map;           ///< that it belongs to
  SE3 T_world_camera;  ///< as the file has it
};

/// A part of a stored atlas, as data. In `parts` are the keyframes and points that are in it; ids
/// that were freed and culled keyframes are left out.
struct AtlasPart {
  AtlasParts parts;                                   ///< what is in it
  std::uint32_t keyframe_slots = 0, point_slots = 0;  ///< of the whole
  std::map<KeyFrameId, FarKeyFrame> far;  ///< those whose pose is known although they are not here
};

/// All maps of a run: keyframes, landmarks, and who sees what.
///
/// One pair of tables holds the keyframes and points of every map; a keyframe says to which map it
/// belongs, so that merging two maps is a relabelling and ids stay valid. Every edit keeps both
/// sides of each link; `check_consistency` proves it in tests.
///
/// Thread: one owner edits; everybody else reads what `snapshot` gave. Pointers from `find` are
/// valid until the next edit.
class Atlas {
 public:
  Atlas(const Camera& camera, const PyramidScales& scales);  ///< Without any map yet.

  /// An atlas from its parts, down to the ids that it will give next. Lists of points per keyframe
  /// are made from the observations, those of children from the parents; what they hold is
  /// ignored. Failure: the first thing that does
  /// not fit together, without a file name.
  static Result<Atlas> restore(AtlasParts parts);

  /// An atlas to be read, in which only a part of a stored one is, under the ids of the whole.
  /// Observations by other keyframes, and points without any left, are dropped; neighbours, parents
  /// and loops that are not in it are named all the same, and `find` gives null for them. Words are
  /// indexed of what is in it. Failure: as restore.
  static Result<Atlas> restore_part(AtlasPart part);

  const Camera& camera() const { return camera_; }         ///< That all keyframes were taken with.
  const PyramidScales& scales() const { return scales_; }  ///< Of the extractor's pyramid.
  /// Counts edits: two atlases of one run with equal revisions are equal.
  std::uint64_t revision() const { return revision_; }

  /// Null when it is not, or no longer, kept.
  const KeyFrame* find(KeyFrameId id) const { return keyframes_.find(id); }
  /// Null when there is no such landmark, or no longer.
  const MapPoint* find(MapPointId id) const { return points_.find(id); }
  /// @throws std::logic_error unless it is kept.
  const KeyFrame& at(KeyFrameId id) const { return keyframes_.at(id); }
  /// @throws std::logic_error unless it is there.
  const MapPoint& at(MapPointId id) const { return points_.at(id); }
  const Table<KeyFrame, KeyFrameTag>& keyframes() const { return keyframes_; }  ///< Of all maps.
  /// Landmarks of all maps.
  const Table<MapPoint, MapPointTag>& points() const { return points_; }

  /// A name for a further map.
  MapId new_map();

  /// Adds a keyframe; its points are linked (ids that are stale or already seen by it are dropped).
  /// The serial is given here.
  KeyFrameId add_keyframe(KeyFrame keyframe);
  /// Adds a point seen by keypoint `keypoint` of `keyframe`, which must be free.
  MapPointId add_point(const Eigen::Vector3d& p_world, KeyFrameId keyframe, int keypoint);
  /// Links a point and a keypoint. False, and no change, if either side is already linked.
  bool add_observation(MapPointId point, KeyFrameId keyframe, int keypoint);
  /// Unlinks; a point with no observation left is removed.
  void remove_observation(MapPointId point, KeyFrameId keyframe);
  /// Moves all observations of `from` to `into` where `into` has none yet, adds its counters, and
  /// removes `from`.
  void merge_points(MapPointId from, MapPointId into);
  void remove_point(MapPointId point);  ///< Takes a landmark out, with all its observations.
  /// Takes a keyframe out: its points lose an observation, its children get a new parent, and where
  /// it stood is remembered relative to its parent. The first keyframe of a map cannot be culled.
  void cull_keyframe(KeyFrameId keyframe);

  /// Moves a keyframe; its points stay.
  void set_pose(KeyFrameId keyframe, const SE3& T_world_camera);
  /// Moves a landmark, metres.
  void set_position(MapPointId point, const Eigen::Vector3d& p_world);
  /// Hangs a keyframe below another in the spanning tree.
  void set_parent(KeyFrameId keyframe, KeyFrameId parent);
  void set_map(KeyFrameId keyframe, MapId map);  ///< Puts a keyframe into another map.
  /// Remembers that two keyframes closed a loop.
  void add_loop(KeyFrameId a, KeyFrameId b);
  /// Makes `root` hang below `parent`, turning round the chain of parents above it: merges the
  /// spanning tree of one map to another's.
  void reroot(KeyFrameId root, KeyFrameId parent);
  /// Adds to how often a point should have been seen and was.
  void count_views(MapPointId point, int visible, int found);
  /// Recomputes descriptor, normal and distances of a point from its observations.
  void refresh_point(MapPointId point);
  /// Recomputes with whom a keyframe shares points; connects those with at least `min_weight`
  /// (always the strongest), on both sides. Gives a parent if it has none and is not the first.
  void refresh_covisibility(KeyFrameId keyframe, int min_weight);

  /// Pose of a keyframe, also of a culled or far one. Nothing for an id that never was.
  std::optional<SE3> T_world_keyframe(KeyFrameId id) const;
  /// The keyframe itself while it is kept, else the nearest kept one that it hangs on. Empty for an
  /// id that never was, or of a far one.
  KeyFrameId nearest_kept(KeyFrameId id) const;

  /// The map that a keyframe belongs to, also of a culled or far one. Empty for an id that never
  /// was.
  MapId map_of(KeyFrameId id) const;

  /// Where keyframes stood that are no longer kept.
  const CulledKeyFrames& culled() const { return culled_; }
  /// Every keyframe that has words.
  const WordIndex& word_index() const { return word_index_; }
  /// What the next keyframe will be numbered.
  std::int64_t next_serial() const { return next_serial_; }
  /// How many maps have been named.
  std::uint32_t maps() const { return maps_; }

  /// The keyframe added last that is still kept; empty when there is none.
  KeyFrameId newest_keyframe() const { return newest_; }
  /// Whether a keyframe is the one that started its map.
  bool is_first(KeyFrameId id) const;

  /// An immutable copy; O(size / 4096).
  std::shared_ptr<const Atlas> snapshot();
  /// Of a snapshot: a copy for whoever asks to move things in, in any thread.
  Atlas fork() const;
  /// What was not taken over from a fork, as it has been edited or added meanwhile.
  struct Newer {
    std::vector<KeyFrameId> keyframes;  ///< in the order of their slots
    std::vector<MapPointId> points;     ///< likewise
  };
  /// Takes over where a fork of `before`, an earlier snapshot of this atlas, has put keyframes and
  /// points; in the fork nothing else may have been edited. Costs as much as has been edited here
  /// meanwhile, and O(size / 4096).
  Newer adopt_places(const Atlas& before, const Atlas& fork);

  /// Empty when all links hold; else one line per violation.
  std::vector<std::string> check_consistency() const;

 private:
  Atlas(const Atlas& other, Table<KeyFrame, KeyFrameTag> keyframes,
        Table<MapPoint, MapPointTag> points);
  void unlink(MapPointId point, const Observation& observation);
  void connect(KeyFrameId from, KeyFrameId to, int weight);
  void drop_connections(KeyFrameId keyframe);
  void link_parent(KeyFrameId keyframe, KeyFrameId parent);
  KeyFrameId best_new_parent(KeyFrameId child, const std::vector<KeyFrameId>& orphans) const;
  void adopt_children(KeyFrameId culled);
  KeyFrameId youngest() const;
  const FarKeyFrame* find_far(KeyFrameId id) const;
  void check_tree(std::vector<std::string>& faults) const;
  void check_words(std::vector<std::string>& faults) const;

  Camera camera_;
  PyramidScales scales_;
  Table<KeyFrame, KeyFrameTag> keyframes_;
  Table<MapPoint, MapPointTag> points_;
  CulledKeyFrames culled_;
  WordIndex word_index_;
  std::uint64_t revision_ = 0;
  KeyFrameId newest_;
  std::int64_t next_serial_ = 0;
  std::uint32_t maps_ = 0;
  std::shared_ptr<const std::map<KeyFrameId, FarKeyFrame>> far_;  ///< null: it is whole
};

/// Keypoint `i` as bundle adjustment and pose optimisation want it: u, v, virtual right u
/// (negative: none), undistorted pixels.
inline Eigen::Vector3d uvr_px(const Features& features, int i) {
  const auto k = static_cast<std::size_t>(i);
  return {features.undistorted_px[k].x(), features.undistorted_px[k].y(), features.right_px[k]};
}

}  // namespace ydd
