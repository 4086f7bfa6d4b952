// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/atlas.h"

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/map_dump.h"
#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using testing::IsEmpty;
using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::hand_held;
using testing_world::keyframe_of;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::View;

/// A few views of one world, every keypoint linked.
BuiltMap small_map(int views, int min_weight = 15) {
  const PointWorld world = make_world(150, 3);
  std::vector<View> seen;
  for (int i = 0; i < views; ++i) seen.push_back(look(world, hand_held(0.2 * i)));
  return build_map(world, seen, min_weight);
}

MapPointId some_point(const Atlas& atlas, KeyFrameId id) {
  for (const MapPointId point : atlas.at(id).points) {
    if (point.valid()) return point;
  }
  return {};
}

int shared_points(const Atlas& atlas, KeyFrameId a, KeyFrameId b) {
  int shared = 0;
  for (const MapPointId id : atlas.at(a).points) {
    const auto& other = atlas.at(b).points;
    if (id.valid() && std::find(other.begin(), other.end(), id) != other.end()) ++shared;
  }
  return shared;
}

/// Follows parents to a keyframe that starts a map; false if the way is a ring or ends elsewhere.
bool leads_to_first(const Atlas& atlas, KeyFrameId id) {
  for (std::size_t steps = 0; steps <= atlas.keyframes().size(); ++steps) {
    if (!atlas.at(id).parent.valid()) return atlas.is_first(id);
    id = atlas.at(id).parent;
  }
  return false;
}

bool is_tree(const Atlas& atlas) {
  const auto ids = atlas.keyframes().ids();
  return std::all_of(ids.begin(), ids.end(),
                     [&](KeyFrameId id) { return leads_to_first(atlas, id); });
}

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

TEST(Atlas, AddKeyframeLinksItsPointsAndDropsWhatItCannotLink) {
  BuiltMap built = small_map(2);
  Atlas& atlas = built.atlas;
  const MapPointId gone = some_point(atlas, built.keyframes[0]);
  atlas.remove_point(gone);
  const MapPointId kept = some_point(atlas, built.keyframes[0]);
  KeyFrame next = keyframe_of(look(make_world(150, 3), hand_held(1.0)));
  next.points.assign(next.features().size(), MapPointId{});
  next.points[0] = gone;  // stale
  next.points[1] = kept;
  next.points[2] = kept;                        // a second time
  next.covisible = {{built.keyframes[0], 99}};  // nothing of the sort is taken over
  const KeyFrameId id = atlas.add_keyframe(next);
  EXPECT_FALSE(atlas.at(id).points[0].valid());
  EXPECT_EQ(atlas.at(id).points[1], kept);
  EXPECT_FALSE(atlas.at(id).points[2].valid());
  EXPECT_EQ(atlas.at(kept).observations.back(), (Observation{id, 1}));
  EXPECT_THAT(atlas.at(id).covisible, IsEmpty());
  EXPECT_EQ(atlas.newest_keyframe(), id);
  EXPECT_EQ(atlas.at(id).serial, 2);
  atlas.set_parent(id, built.keyframes[0]);
  atlas.set_map(id, atlas.at(built.keyframes[0]).map);
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, AddPointOnATakenKeypointThrowsAndChangesNothing) {
  BuiltMap built = small_map(1);
  const std::string before = dump_map(built.atlas);
  EXPECT_THROW(built.atlas.add_point({0, 0, 2}, built.keyframes[0], 0), std::logic_error);
  EXPECT_EQ(dump_map(built.atlas), before);
  EXPECT_THAT(built.atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, AddSightingRefusesEitherSideThatIsLinked) {
  BuiltMap built = small_map(2);
  Atlas& atlas = built.atlas;
  const KeyFrameId first = built.keyframes[0];
  const MapPointId a = atlas.at(first).points[0];
  const MapPointId b = atlas.at(first).points[1];
  atlas.remove_observation(b, first);
  const std::uint64_t revision = atlas.revision();
  EXPECT_FALSE(atlas.add_observation(a, first, 1));  // sees a already
  EXPECT_EQ(atlas.revision(), revision);
  EXPECT_TRUE(atlas.add_observation(b, first, 1));
  EXPECT_FALSE(atlas.add_observation(b, first, 0));  // keypoint 0 is taken
  EXPECT_GT(atlas.revision(), revision);
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, APointGoesWithItsLastSighting) {
  BuiltMap built = small_map(2);
  Atlas& atlas = built.atlas;
  const auto seen_by_both = std::find_if(
      built.points.begin(), built.points.end(),
      [&](MapPointId id) { return id.valid() && atlas.at(id).observations.size() == 2; });
  ASSERT_NE(seen_by_both, built.points.end());
  atlas.remove_observation(*seen_by_both, built.keyframes[0]);
  ASSERT_NE(atlas.find(*seen_by_both), nullptr);
  atlas.remove_observation(*seen_by_both,
                           built.keyframes[0]);  // no such observation: nothing happens
  EXPECT_NE(atlas.find(*seen_by_both), nullptr);
  atlas.remove_observation(*seen_by_both, built.keyframes[1]);
  EXPECT_EQ(atlas.find(*seen_by_both), nullptr);
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, StaleIdsAreToldNotFollowed) {
  BuiltMap built = small_map(3);
  Atlas& atlas = built.atlas;
  const MapPointId point = some_point(atlas, built.keyframes[0]);
  atlas.remove_point(point);
  const auto k = std::find(atlas.at(built.keyframes[0]).points.begin(),
                           atlas.at(built.keyframes[0]).points.end(), MapPointId{});
  const int free = static_cast<int>(k - atlas.at(built.keyframes[0]).points.begin());
  const MapPointId tenant = atlas.add_point({0, 0, 2}, built.keyframes[0], free);
  EXPECT_EQ(tenant.slot, point.slot);  // the slot is used again
  EXPECT_EQ(atlas.find(point), nullptr);
  EXPECT_THROW(atlas.at(point), std::logic_error);
  EXPECT_THROW(atlas.set_position(point, {}), std::logic_error);
  EXPECT_THROW(atlas.remove_point(point), std::logic_error);
  EXPECT_THROW(atlas.merge_points(point, tenant), std::logic_error);
  atlas.cull_keyframe(built.keyframes[1]);
  EXPECT_EQ(atlas.find(built.keyframes[1]), nullptr);
  EXPECT_THROW(atlas.set_pose(built.keyframes[1], SE3()), std::logic_error);
  EXPECT_THROW(atlas.cull_keyframe(built.keyframes[1]), std::logic_error);
  EXPECT_FALSE(atlas.T_world_keyframe({77, 1}).has_value());
  EXPECT_FALSE(atlas.T_world_keyframe({}).has_value());
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, MergeMovesSightingsWhereThereIsRoomAndAddsCounters) {
  const PointWorld world = make_world(150, 3);
  const View view = look(world, SE3());
  Atlas atlas(world.camera, world.scales);
  std::vector<KeyFrameId> ids;
  for (int i = 0; i < 3; ++i) {
    ids.push_back(atlas.add_keyframe(keyframe_of(view, i)));
    if (i > 0) atlas.set_parent(ids.back(), ids.front());
  }
  const MapPointId from = atlas.add_point({0, 0, 2}, ids[0], 0);
  const MapPointId into = atlas.add_point({0, 0, 2.1}, ids[1], 1);
  ASSERT_TRUE(atlas.add_observation(from, ids[1], 0));  // both are seen by keyframe 1
  ASSERT_TRUE(atlas.add_observation(from, ids[2], 5));
  atlas.count_views(from, 4, 3);
  atlas.count_views(into, 2, 1);
  atlas.merge_points(from, into);
  EXPECT_EQ(atlas.find(from), nullptr);
  const MapPoint& merged = atlas.at(into);
  EXPECT_THAT(merged.observations,
              testing::UnorderedElementsAre(Observation{ids[0], 0}, Observation{ids[1], 1},
                                            Observation{ids[2], 5}));
  EXPECT_EQ(merged.visible, 1 + 2 + 1 + 4);
  EXPECT_EQ(merged.found, 1 + 1 + 1 + 3);
  EXPECT_EQ(merged.p_world.z(), 2.1);
  EXPECT_FALSE(atlas.at(ids[1]).points[0].valid());
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
  const std::string before = dump_map(atlas);
  atlas.merge_points(into, into);
  EXPECT_EQ(dump_map(atlas), before);
}

TEST(Atlas, RefreshPointTellsFromWhereItCanBeSeen) {
  const PointWorld world = make_world(150, 3);
  const std::vector<View> views = {look(world, SE3()), look(world, hand_held(1.0))};
  const BuiltMap built = build_map(world, views);
  for (std::size_t i = 0; i < built.points.size(); ++i) {
    const MapPoint* point = built.atlas.find(built.points[i]);
    if (!point) continue;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Observation& s : point->observations) {
      mean +=
          (point->p_world - built.atlas.at(s.keyframe).T_world_camera.translation()).normalized();
    }
    EXPECT_NEAR((point->normal - mean.normalized()).norm(), 0, 1e-12);
    EXPECT_EQ(point->descriptor, world.descriptors[i]);
    EXPECT_LE(point->max_distance_m, world.farthest_m[i] * 1.0001);
    EXPECT_GT(point->max_distance_m * 1.2001, world.farthest_m[i]);
    EXPECT_NEAR(point->max_distance_m / point->min_distance_m, std::pow(1.2, 7), 1e-9);
  }
}

TEST(Atlas, CovisibilityCountsSharedPointsOnBothSidesHeaviestFirst) {
  const BuiltMap built = small_map(6, 1);
  const Atlas& atlas = built.atlas;
  for (const KeyFrameId a : built.keyframes) {
    const auto& list = atlas.at(a).covisible;
    EXPECT_EQ(list.size(), built.keyframes.size() - 1);
    for (std::size_t i = 0; i < list.size(); ++i) {
      EXPECT_EQ(list[i].weight, shared_points(atlas, a, list[i].keyframe));
      if (i > 0) {
        EXPECT_GE(list[i - 1].weight, list[i].weight);
      }
    }
  }
}

TEST(Atlas, CovisibilityKeepsTheStrongestEvenIfWeakAndDropsOldWeights) {
  BuiltMap built = small_map(3, 10000);
  Atlas& atlas = built.atlas;
  const KeyFrameId last = built.keyframes[2];
  ASSERT_EQ(atlas.at(last).covisible.size(), 1U);
  EXPECT_EQ(atlas.at(last).parent, atlas.at(last).covisible.front().keyframe);
  const std::vector<MapPointId> points = atlas.at(last).points;
  for (const MapPointId id : points) {
    if (id.valid()) atlas.remove_observation(id, last);
  }
  atlas.refresh_covisibility(last, 1);
  EXPECT_THAT(atlas.at(last).covisible, IsEmpty());
  for (const KeyFrameId id : {built.keyframes[0], built.keyframes[1]}) {
    for (const Covisible& c : atlas.at(id).covisible) EXPECT_NE(c.keyframe, last);
  }
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, CulledKeyframesResolveThroughEveryoneCulledAfterThem) {
  BuiltMap built = small_map(8, 1);
  Atlas& atlas = built.atlas;
  // A chain: each the child of the one before.
  for (std::size_t i = 1; i < 8; ++i) atlas.set_parent(built.keyframes[i], built.keyframes[i - 1]);
  std::map<KeyFrameId, SE3> stood;
  for (const KeyFrameId id : built.keyframes) stood[id] = atlas.at(id).T_world_camera;
  for (const std::size_t i : {6U, 5U, 4U, 2U, 3U}) {
    atlas.cull_keyframe(built.keyframes[i]);
    ASSERT_THAT(atlas.check_consistency(), IsEmpty()) << i;
    ASSERT_TRUE(is_tree(atlas)) << i;
  }
  for (const auto& [id, T_world_camera] : stood) {
    ASSERT_TRUE(atlas.T_world_keyframe(id).has_value());
    EXPECT_NEAR(distance(*atlas.T_world_keyframe(id), T_world_camera), 0, 1e-9);
  }
  // They follow the keyframe that they hang on now.
  const SE3 T_moved = SE3::exp((Vector6d() << 1, 2, 3, 0.1, 0.2, 0.3).finished());
  for (const KeyFrameId id : atlas.keyframes().ids()) {
    atlas.set_pose(id, T_moved * atlas.at(id).T_world_camera);
  }
  for (const auto& [id, T_world_camera] : stood) {
    EXPECT_NEAR(distance(*atlas.T_world_keyframe(id), T_moved * T_world_camera), 0, 1e-9);
  }
}

TEST(Atlas, CullingTheNewestLeavesTheNewestThatIsKept) {
  BuiltMap built = small_map(4, 1);
  Atlas& atlas = built.atlas;
  atlas.cull_keyframe(built.keyframes[2]);
  EXPECT_EQ(atlas.newest_keyframe(), built.keyframes[3]);
  atlas.cull_keyframe(built.keyframes[3]);
  EXPECT_EQ(atlas.newest_keyframe(), built.keyframes[1]);
  EXPECT_THROW(atlas.cull_keyframe(built.keyframes[0]), std::logic_error);
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, CullingNeverMakesARing) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    BuiltMap built = small_map(12, 1);
    Atlas& atlas = built.atlas;
    std::mt19937 random(seed);
    // Any tree: parents are drawn among the older ones, so that orphans see each other's children.
    for (std::size_t i = 1; i < built.keyframes.size(); ++i) {
      atlas.set_parent(built.keyframes[i], built.keyframes[random() % i]);
    }
    std::vector<KeyFrameId> order(built.keyframes.begin() + 1, built.keyframes.end());
    std::shuffle(order.begin(), order.end(), random);
    for (const KeyFrameId id : order) {
      atlas.cull_keyframe(id);
      ASSERT_TRUE(is_tree(atlas)) << "seed " << seed;
      ASSERT_THAT(atlas.check_consistency(), IsEmpty()) << "seed " << seed;
    }
    EXPECT_EQ(atlas.keyframes().size(), 1U);
  }
}

TEST(Atlas, ChildrenAreThoseThatNameTheParent) {
  BuiltMap built = small_map(3, 1);
  built.atlas.set_parent(built.keyframes[1], built.keyframes[0]);
  built.atlas.set_parent(built.keyframes[2], built.keyframes[0]);
  EXPECT_THAT(built.atlas.at(built.keyframes[0]).children,
              testing::ElementsAre(built.keyframes[1], built.keyframes[2]));
  EXPECT_TRUE(built.atlas.is_first(built.keyframes[0]));
  EXPECT_FALSE(built.atlas.is_first(built.keyframes[1]));
}

TEST(Atlas, NearestKeptIsTheOneThatACulledKeyframeHangsOn) {
  BuiltMap built = small_map(4, 1);
  Atlas& atlas = built.atlas;
  for (std::size_t i = 1; i < 4; ++i) atlas.set_parent(built.keyframes[i], built.keyframes[i - 1]);
  EXPECT_EQ(atlas.nearest_kept(built.keyframes[2]), built.keyframes[2]);
  atlas.cull_keyframe(built.keyframes[2]);
  EXPECT_EQ(atlas.nearest_kept(built.keyframes[2]), built.keyframes[1]);
  atlas.cull_keyframe(built.keyframes[1]);
  EXPECT_EQ(atlas.nearest_kept(built.keyframes[2]), built.keyframes[0]);
  EXPECT_FALSE(atlas.nearest_kept({77, 1}).valid());
}

TEST(Atlas, RerootTurnsTheChainRound) {
  BuiltMap built = small_map(5, 1);
  Atlas& atlas = built.atlas;
  const auto& k = built.keyframes;
  atlas.set_parent(k[1], {});
  atlas.set_map(k[1], atlas.new_map());
  for (const std::size_t i : {2U, 3U, 4U}) {
    atlas.set_parent(k[i], k[i - 1]);
    atlas.set_map(k[i], atlas.at(k[1]).map);
  }
  ASSERT_THAT(atlas.check_consistency(), IsEmpty());  // two maps: 0, and 1 2 3 4
  for (const std::size_t i : {1U, 2U, 3U, 4U}) atlas.set_map(k[i], atlas.at(k[0]).map);
  atlas.reroot(k[3], k[0]);
  EXPECT_EQ(atlas.at(k[3]).parent, k[0]);
  EXPECT_EQ(atlas.at(k[2]).parent, k[3]);
  EXPECT_EQ(atlas.at(k[1]).parent, k[2]);
  EXPECT_EQ(atlas.at(k[4]).parent, k[3]);
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

TEST(Atlas, ConsistencyFindsWhatIsWrong) {
  BuiltMap built = small_map(3, 1);
  Atlas& atlas = built.atlas;
  ASSERT_THAT(atlas.check_consistency(), IsEmpty());
  atlas.set_parent(built.keyframes[1], {});
  EXPECT_EQ(atlas.check_consistency().size(), 1U);
  atlas.set_parent(built.keyframes[1], built.keyframes[2]);
  atlas.set_parent(built.keyframes[2], built.keyframes[1]);
  EXPECT_FALSE(atlas.check_consistency().empty()) << "a ring of parents";
}

/// Random edits of an atlas, all that its owner may do.
class Editor {
 public:
  explicit Editor(unsigned seed) : world_(make_world(150, 3)), random_(seed) { add_keyframe(); }

  void edit() {
    switch (draw(11)) {
      case 0:
        return add_keyframe();
      case 1:
      case 2:
        return add_point();
      case 3:
        if (point().valid()) atlas_.add_observation(point(), keyframe(), keypoint());
        return;
      case 4:
        if (const MapPointId id = point(); id.valid()) atlas_.remove_observation(id, keyframe());
        return;
      case 5:
        if (const MapPointId id = point(); id.valid()) atlas_.remove_point(id);
        return;
      case 6:
        return merge();
      case 7:
        return cull();
      case 8:
        atlas_.refresh_covisibility(keyframe(), 1 + static_cast<int>(draw(3)));
        return;
      case 9:
        if (const MapPointId id = point(); id.valid()) atlas_.refresh_point(id);
        return;
      default:
        atlas_.set_pose(keyframe(), hand_held(0.01 * static_cast<double>(draw(400))));
    }
  }

  Atlas& atlas() { return atlas_; }
  const std::map<KeyFrameId, SE3>& ever() const { return ever_; }

 private:
  std::size_t draw(std::size_t n) { return random_() % n; }
  KeyFrameId keyframe() {
    const auto ids = atlas_.keyframes().ids();
    return ids[draw(ids.size())];
  }
  MapPointId point() {
    const auto ids = atlas_.points().ids();
    return ids.empty() ? MapPointId{} : ids[draw(ids.size())];
  }
  int keypoint() { return static_cast<int>(draw(20)); }

  void add_keyframe() {
    KeyFrame keyframe = keyframe_of(look(world_, hand_held(0.05 * static_cast<double>(draw(80)))));
    keyframe.points.resize(20);
    for (MapPointId& id : keyframe.points) id = draw(3) == 0 ? stale_ : point();
    keyframe.map = map_;
    if (!atlas_.keyframes().empty()) keyframe.parent = this->keyframe();
    const KeyFrameId id = atlas_.add_keyframe(std::move(keyframe));
    ever_[id] = atlas_.at(id).T_world_camera;
    atlas_.refresh_covisibility(id, 1);
  }
  void add_point() {
    const KeyFrameId by = keyframe();
    const int k = keypoint();
    const auto free = !atlas_.at(by).points[static_cast<std::size_t>(k)].valid();
    if (free) stale_ = atlas_.add_point({0, 0, 3}, by, k);
  }
  void merge() {
    const MapPointId from = point();
    const MapPointId into = point();
    if (from.valid()) atlas_.merge_points(from, into);
  }
  void cull() {
    const KeyFrameId id = keyframe();
    if (!atlas_.is_first(id)) atlas_.cull_keyframe(id);
  }

  PointWorld world_;
  std::mt19937 random_;
  Atlas atlas_{world_.camera, world_.scales};
  MapId map_ = atlas_.new_map();
  MapPointId stale_;
  std::map<KeyFrameId, SE3> ever_;  ///< all keyframes that ever were
};

TEST(Atlas, EveryEditKeepsAllLinks) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Editor editor(seed);
    for (int i = 0; i < 400; ++i) {
      editor.edit();
      ASSERT_THAT(editor.atlas().check_consistency(), IsEmpty())
          << "seed " << seed << " edit " << i;
      ASSERT_TRUE(is_tree(editor.atlas())) << "seed " << seed << " edit " << i;
    }
    EXPECT_GT(editor.ever().size(), editor.atlas().keyframes().size());
    for (const auto& [id, pose] : editor.ever()) {
      EXPECT_TRUE(editor.atlas().T_world_keyframe(id).has_value());
    }
  }
}

TEST(Atlas, SnapshotsDoNotChange) {
  Editor editor(11);
  std::vector<std::pair<std::shared_ptr<const Atlas>, std::string>> taken;
  std::vector<std::pair<KeyFrameId, SE3>> resolved;
  for (int i = 0; i < 400; ++i) {
    editor.edit();
    if (i % 40 != 0) continue;
    taken.emplace_back(editor.atlas().snapshot(), dump_map(editor.atlas()));
    resolved.emplace_back(editor.ever().begin()->first,
                          *editor.atlas().T_world_keyframe(editor.ever().begin()->first));
  }
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const auto& [snapshot, dump] = taken[i];
    EXPECT_EQ(dump_map(*snapshot), dump);
    EXPECT_THAT(snapshot->check_consistency(), IsEmpty());
    EXPECT_EQ(snapshot->T_world_keyframe(resolved[i].first)->matrix(), resolved[i].second.matrix());
    EXPECT_LE(snapshot->revision(), editor.atlas().revision());
  }
}

TEST(MapDump, EqualEditsGiveEqualDumpsAndOneBitShows) {
  Editor a(5);
  Editor b(5);
  for (int i = 0; i < 200; ++i) {
    a.edit();
    b.edit();
  }
  EXPECT_EQ(dump_map(a.atlas()), dump_map(b.atlas()));
  ASSERT_FALSE(a.atlas().points().empty());
  const MapPointId id = a.atlas().points().ids().front();
  Eigen::Vector3d p = a.atlas().at(id).p_world;
  p.x() = std::nextafter(p.x(), 10.0);
  a.atlas().set_position(id, p);
  EXPECT_NE(dump_map(a.atlas()), dump_map(b.atlas()));
}

}  // namespace
}  // namespace ydd
