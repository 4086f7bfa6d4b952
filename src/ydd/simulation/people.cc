// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/people.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "ydd/simulation/closed_curve.h"
#include "ydd/simulation/furniture.h"
#include "ydd/simulation/gait.h"
#include "ydd/simulation/motions.h"
#include "ydd/simulation/person.h"
#include "ydd/simulation/room.h"
#include "ydd/simulation/visitors.h"

namespace ydd::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// Way of a walker: a closed curve, shifted, walked at a speed that swells and fades.
struct Way {
  std::shared_ptr<const ClosedCurve> curve;
  Vector2d shift_m = Vector2d::Zero();
  double start_m = 0;
  double speed = 0.6;     ///< mean, m/s
  double unevenness = 0;  ///< 0: constant speed, near 1: almost stands still now and then
  double period_s = 9.0;

  double distance_m(double t) const {
    return start_m + speed * (t - unevenness * period_s / kTurn * std::sin(kTurn * t / period_s));
  }
  double speed_at(double t) const {
    return speed * (1.0 - unevenness * std::cos(kTurn * t / period_s));
  }
};

/// What somebody does with the hands while walking.
enum class Errand { none, cup, book, chair };

struct Walker {
  PersonShape shape;
  Way way;
  Errand errand = Errand::none;
};

constexpr double kChairAhead_m = 0.66;
constexpr double kBackrestHeight_m = 0.93;

PersonPose walk(const Walker& walker, double t) {
  const double s = walker.way.distance_m(t);
  const Vector2d here = walker.way.curve->at(s) + walker.way.shift_m;
  const Vector2d ahead = walker.way.curve->at(s + 0.2) - walker.way.curve->at(s - 0.2);
  const double liveliness = std::min(1.0, walker.way.speed_at(t) / 0.5);
  PersonPose pose = stride(walker.shape, s, liveliness);
  pose.T_world_person = on_floor(here, std::atan2(ahead.y(), ahead.x()));
  pose.head_turn = 0.25 * std::sin(0.9 * t + walker.way.start_m);
  return pose;
}

/// Hands where the errand needs them.
PersonPose with_errand(const Walker& walker, PersonPose pose) {
  const double hips = standing_hip_height(walker.shape, pose);
  const auto hand_to = [&](int side, const Vector3d& target) {
    const SE3 chest = chest_in_person(walker.shape, pose, hips);
    pose.arms[side] = reach(walker.shape, chest, side, target);
  };
  const double scale = walker.shape.scale;
  if (walker.errand == Errand::cup) hand_to(1, scale * Vector3d(0.20, 0.33, 1.20));
  if (walker.errand == Errand::book) hand_to(0, scale * Vector3d(-0.20, 0.28, 1.12));
  if (walker.errand == Errand::chair) {
    pose.lean = 0.18;
    for (int side = 0; side < 2; ++side) {
      hand_to(side, {side == 0 ? -0.18 : 0.18, 0.40, kBackrestHeight_m});
    }
  }
  return pose;
}

/// A carried thing at the palm, upright, turned with the person.
SE3 in_hand(const SE3& T_world_hand, const SE3& T_world_person, const Vector3d& offset_hand_m,
            double below_m) {
  const Vector3d palm = T_world_hand * offset_hand_m;
  return {T_world_person.rotation(), palm - Vector3d(0, 0, below_m)};
}

std::vector<SE3> place_walker(const Walker& walker, double t) {
  const PersonPose pose = with_errand(walker, walk(walker, t));
  std::vector<SE3> T = place_person(walker.shape, pose);
  switch (walker.errand) {
    case Errand::cup:
      T.push_back(in_hand(T[kHand + 1], pose.T_world_person, {-0.055, 0.01, -0.09}, 0.05));
      break;
    case Errand::book:
      T.push_back(T[kHand] * shift(0.022, 0.02, -0.10));
      break;
    case Errand::chair:
      T.push_back(pose.T_world_person * shift(0, kChairAhead_m, 0) * yaw(std::numbers::pi));
      break;
    case Errand::none:
      break;
  }
  return T;
}

/// Book in the plane of the palm: its thickness along x.
Parts upright_book(SceneBuilder& builder, int object) {
  Parts parts = make_flat_book(builder, object, 0.19F, 0.26F);
  const SE3 to_palm(Eigen::Quaterniond(Eigen::AngleAxisd(0.25 * kTurn, Vector3d::UnitY())),
                    Vector3d::Zero());
  for (Part& part : parts) part.mesh = transformed(part.mesh, to_palm);
  return parts;
}

void add_walker(SceneBuilder& builder, int number, Walker walker) {
  Random random = builder.next_random();
  walker.shape.scale = random.uniform(0.94, 1.06);
  const PersonObjects objects = add_person_objects(builder, number);
  Actor actor;
  actor.bodies = make_person_bodies(builder, objects, walker.shape, random.fork(1));
  if (walker.errand == Errand::cup) {
    actor.bodies.push_back({make_mug(builder, builder.add_mover("cup", "carried_cup"))});
  } else if (walker.errand == Errand::book) {
    actor.bodies.push_back({upright_book(builder, builder.add_mover("book", "carried_book"))});
  } else if (walker.errand == Errand::chair) {
    actor.bodies.push_back({make_chair(builder, builder.add_mover("chair", "pushed_chair"))});
  }
  actor.poses = [walker](double t) { return place_walker(walker, t); };
  builder.add_actor(std::move(actor));
}

/// Somebody at desk `place`, typing: hands and head move, the body hardly.
PersonPose sit(const PersonShape& shape, int place, double t) {
  PersonPose pose;
  pose.T_world_person =
      on_floor({kChairPlaces_m[place][0], kChairPlaces_m[place][1] - 0.02}, 0.25 * kTurn);
  pose.hip_height_m = 0.56;
  pose.lean = 0.12 + 0.02 * std::sin(0.8 * t);
  pose.head_turn = 0.35 * std::sin(0.5 * t + place) + 0.1 * std::sin(1.7 * t);
  pose.head_nod = -0.12;
  const SE3 chest = chest_in_person(shape, pose, pose.hip_height_m);
  for (int side = 0; side < 2; ++side) {
    const double tap = 0.03 * std::max(0.0, std::sin(9.0 * t + 2.0 * side));
    const double glide = 0.05 * std::sin(1.1 * t + side);
    pose.legs[side] = {1.42, 1.4, 0.0};
    pose.arms[side] =
        reach(shape, chest, side, {(side == 0 ? -0.12 : 0.14) + glide, 0.46, 0.80 + tap});
  }
  return pose;
}

void add_sitter(SceneBuilder& builder, int number, int place) {
  add_person(builder, number, 1.04,
             [place](const PersonShape& shape, double t) { return sit(shape, place, t); });
}

void add_fan(SceneBuilder& builder, bool turns) {
  const Vector3d place(kFanPlace_m[0], kFanPlace_m[1], kFanPlace_m[2]);
  const SE3 T_world_foot(Eigen::Quaterniond::Identity(), place);
  const SE3 axis = T_world_foot * shift(0, -0.06, static_cast<double>(kFanAxisHeight_m));
  const int object = turns ? builder.add_mover("fan", "fan") : builder.add_object("fan");
  const Fan fan = make_fan(builder, object);
  builder.place(fan.foot, T_world_foot);
  if (!turns) {
    builder.place(fan.head, axis);
    builder.place(fan.rotor, axis);
    return;
  }
  Actor actor;
  actor.bodies = {{fan.head}, {fan.rotor}};
  actor.poses = [axis](double t) {
    constexpr double kSwing_rad = 0.5;
    constexpr double kSwingPeriod_s = 7.0;
    constexpr double kRotorTurns_per_s = 1.7;
    const SE3 head = axis * yaw(kSwing_rad * std::sin(kTurn * t / kSwingPeriod_s));
    const Eigen::AngleAxisd spin(std::fmod(kTurn * kRotorTurns_per_s * t, kTurn),
                                 Vector3d::UnitY());
    return std::vector<SE3>{head, head * SE3(Eigen::Quaterniond(spin), Vector3d::Zero())};
  };
  builder.add_actor(std::move(actor));
}

std::shared_ptr<const ClosedCurve> ellipse(const Vector2d& centre, double half_x, double half_y) {
  std::vector<Vector2d> points;
  constexpr int kPoints = 12;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = kTurn * i / kPoints;
    points.push_back(centre + Vector2d(half_x * std::cos(angle), half_y * std::sin(angle)));
  }
  return std::make_shared<const ClosedCurve>(points);
}

/// A group that walks to and fro right before the camera, all in the same direction at any time:
/// what a tracker that believes in a static world would take for its own motion.
std::vector<Walker> close_group(int count) {
  const auto curve = ellipse({2.9, 2.70}, 0.58, 0.2);
  const Vector2d places[] = {{-0.40, 0.0}, {0.36, 0.2}, {-0.05, 0.75}, {0.95, 0.75}, {-0.95, 0.8}};
  std::vector<Walker> walkers;
  for (int i = 0; i < count; ++i) {
    Walker walker;
    walker.way = {curve, places[i % 5] + Vector2d(0, 0.35 * (i / 5)), 0.0, 0.5, 0.0, 9.0};
    walker.errand = i == 0 ? Errand::cup : (i == 1 ? Errand::book : Errand::none);
    walkers.push_back(walker);
  }
  return walkers;
}

/// People one after the other on a round through the free part of the room. On the room loop the
/// camera walks round the room itself, and they stay in the middle.
std::vector<Walker> round_walk(int count, bool chair, bool room_loop) {
  const auto curve = room_loop ? ellipse({3.0, 2.2}, 0.75, 0.3) : ellipse({2.8, 2.95}, 1.35, 0.42);
  std::vector<Walker> walkers;
  for (int i = 0; i < count; ++i) {
    Walker walker;
    walker.way = {curve, Vector2d::Zero(), curve->length_m() * i / count, 0.6, 0.85, 9.0};
    constexpr Errand kErrands[] = {Errand::cup, Errand::chair, Errand::book, Errand::none};
    walker.errand = kErrands[i % 4];
    if (walker.errand == Errand::chair && !chair) walker.errand = Errand::none;
    walkers.push_back(walker);
  }
  return walkers;
}

}  // namespace

Cast choose_cast(const WorldOptions& options) {
  Cast cast;
  const int people = options.busy && options.people == 0 ? 3 : options.people;
  cast.close = options.busy;
  cast.fan_turns = people > 0;
  if (options.busy) {
    cast.walkers = people;
    return cast;
  }
  // The second one sits, then walkers again, the second of which pushes a chair.
  cast.sitters = people >= 2 ? (people >= 5 ? 2 : 1) : 0;
  cast.walkers = people - cast.sitters;
  cast.pushed_chair = cast.walkers >= 2 && cast.sitters < 2 && options.path != PathKind::room_loop;
  return cast;
}

void add_actors(SceneBuilder& builder, const WorldOptions& options, const Cast& cast) {
  const std::vector<Walker> walkers =
      cast.close ? close_group(cast.walkers)
                 : round_walk(cast.walkers, cast.pushed_chair, options.path == PathKind::room_loop);
  int number = 0;
  for (const Walker& walker : walkers) add_walker(builder, number++, walker);
  for (int i = 0; i < cast.sitters; ++i) add_sitter(builder, number++, 1 - i);
  add_fan(builder, cast.fan_turns);
  if (options.sit_then_leave) add_leaver(builder, number++);
  if (options.come_and_stay) add_comer(builder, number++);
}

}  // namespace ydd::sim
