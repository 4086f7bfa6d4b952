// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/track_errors.h"

#include <algorithm>
#include <map>
#include <optional>

#include <Eigen/Cholesky>

namespace ydd {
namespace {

constexpr double kLeastShare = 0.005;  // of the picture, of who is to be seen
constexpr double kSettled_s = 1.0;     // until a velocity is told from a position
constexpr double kWithinChi2 = 5.99;   // 95 % of two degrees of freedom

/// What a person does in one frame.
struct Person {
  const SimulatedMover* mover = nullptr;
  bool wanted = false;
};

struct Pair {
  std::size_t track = 0, person = 0;
};

std::vector<Person> people_of(const SimulatedStep& step, const std::vector<SimulatedMover>& movers,
                              int picture_px) {
  std::vector<Person> out;
  for (const SimulatedMover& mover : movers) {
    if (mover.class_name != "person") continue;
    const bool wanted =
        std::any_of(step.visible.begin(), step.visible.end(), [&](const SimulatedObject& o) {
          return o.name == mover.name && o.pixels >= kLeastShare * picture_px;
        });
    out.push_back({&mover, wanted});
  }
  return out;
}

/// One frame after the other.
class Comparison {
 public:
  void frame(const std::vector<WorldTrack>& tracks, const std::vector<Person>& people,
             const SE3& T_true_world) {
    std::vector<Eigen::Vector3d> places;
    for (const WorldTrack& t : tracks) places.push_back(T_true_world * t.position_m);
    const std::vector<Pair> pairs = pair_up(tracks, places, people);
    out_.told += static_cast<int>(tracks.size());
    out_.false_ones += static_cast<int>(tracks.size() - pairs.size());
    for (const Person& person : people) out_.wanted += person.wanted ? 1 : 0;
    for (const Pair& pair : pairs) {
      count(tracks[pair.track], places[pair.track], people[pair.person], T_true_world);
    }
  }
  const TrackErrors& errors() const { return out_; }

 private:
  static double across(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - b).head<2>().norm();
  }

  std::vector<Pair> pair_up(const std::vector<WorldTrack>& tracks,
                            const std::vector<Eigen::Vector3d>& places,
                            const std::vector<Person>& people) const {
    struct Candidate {
      double rank;
      Pair pair;
    };
    std::vector<Candidate> candidates;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      for (std::size_t p = 0; p < people.size(); ++p) {
        const double off_m = across(places[t], people[p].mover->middle_m);
        if (off_m > kPair_m) continue;
        const auto before = last_.find(people[p].mover->id);
        const bool same = before != last_.end() && before->second == tracks[t].id;
        candidates.push_back({same ? off_m - kPair_m : off_m, {t, p}});
      }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
    std::vector<bool> track_taken(tracks.size()), person_taken(people.size());
    std::vector<Pair> out;
    for (const Candidate& c : candidates) {
      if (track_taken[c.pair.track] || person_taken[c.pair.person]) continue;
      track_taken[c.pair.track] = person_taken[c.pair.person] = true;
      out.push_back(c.pair);
    }
    return out;
  }

  void count(const WorldTrack& track, const Eigen::Vector3d& place, const Person& person,
             const SE3& T_true_world) {
    const SimulatedMover& truth = *person.mover;
    if (person.wanted) ++out_.found;
    const auto [last, first_time] = last_.try_emplace(truth.id, track.id);
    if (!first_time && last->second != track.id) ++out_.switches;
    last->second = track.id;
    const Eigen::Vector3d off_m = place - truth.middle_m;
    out_.across_m.push_back(off_m.head<2>().norm());
    out_.height_m.push_back(std::abs(off_m.z()));
    const Eigen::Matrix3d R = T_true_world.rotation_matrix();
    const Eigen::Matrix2d S =
        (R * track.position_covariance_m2 * R.transpose()).topLeftCorner<2, 2>();
    const Eigen::Vector2d floor_m = off_m.head<2>();
    if (floor_m.dot(S.llt().solve(floor_m)) <= kWithinChi2) ++out_.within;
    if (track.age_s >= kSettled_s) {
      out_.velocity_m_s.push_back((R * track.velocity_m_s - truth.velocity_m_s).head<2>().norm());
    }
  }

  TrackErrors out_;
  std::map<int, std::int64_t> last_;  ///< track of each person
};

}  // namespace

void TrackErrors::add(const TrackErrors& other) {
  wanted += other.wanted;
  found += other.found;
  told += other.told;
  false_ones += other.false_ones;
  switches += other.switches;
  within += other.within;
  across_m.insert(across_m.end(), other.across_m.begin(), other.across_m.end());
  height_m.insert(height_m.end(), other.height_m.begin(), other.height_m.end());
  velocity_m_s.insert(velocity_m_s.end(), other.velocity_m_s.begin(), other.velocity_m_s.end());
}

TrackErrors track_errors(const SimulatedRun& run, const Simulator& simulator) {
  const Camera& camera = simulator.camera();
  Comparison comparison;
  std::optional<SE3> T_true_world;
  for (std::size_t i = 0; i < run.steps.size(); ++i) {
    const SimulatedStep& step = run.steps[i];
    if (!T_true_world && step.state == TrackingState::tracking) {
      T_true_world = step.T_true_camera * step.T_world_camera.inverse();
    }
    if (!T_true_world) continue;
    const std::vector<SimulatedMover> movers = simulator.movers(static_cast<int>(i));
    std::vector<WorldTrack> people;
    for (const WorldTrack& track : step.tracks) {
      if (track.class_name == "person") people.push_back(track);
    }
    comparison.frame(people, people_of(step, movers, camera.width_px * camera.height_px),
                     *T_true_world);
  }
  return comparison.errors();
}

}  // namespace ydd
