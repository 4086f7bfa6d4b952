// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "ydd/geometry/se3.h"
#include "ydd/simulation/random.h"
#include "ydd/studies/sessions.h"

namespace ydd {
namespace {

LightKind light_of_visit(int number, sim::Random& random) {
  constexpr std::array<LightKind, 4> kLights = {LightKind::day, LightKind::evening,
                                                LightKind::lamps, LightKind::changing};
  // The first ten see them all, so that what comes later is no news.
  const int drawn = random.integer(0, static_cast<int>(kLights.size()) - 1);
  return kLights[static_cast<std::size_t>(number < 4 ? number : drawn)];
}

}  // namespace

SessionPlan visits(const VisitOptions& options) {
  const TimedPath round = make_camera_path(options.world);
  return [options, round](int number) {
    const auto seed = static_cast<std::uint64_t>(options.world.seed);
    sim::Random random(
        sim::mix_bits(sim::mix_bits(seed, 5000), static_cast<std::uint64_t>(number)));
    Session session;
    session.world = options.world;
    if (options.light_changes) {
      session.world.light = light_of_visit(number, random);
      session.world.light_seed = 1000 * options.world.seed + number;
      session.world.light_change_s = 3.0;
    }
    const bool first = number == 0;
    const double length_s = first ? round.round_s : options.seconds;
    session.world.frames = static_cast<int>(std::lround(length_s * options.world.fps));
    const double start_s = first ? 0.0 : random.uniform(0.0, round.round_s);
    const Eigen::Vector3d aside(random.uniform(-0.15, 0.15), random.uniform(-0.06, 0.06), 0.0);
    const SE3 held(
        so3_exp(Eigen::Vector3d(random.uniform(-0.04, 0.04), random.uniform(-0.12, 0.12), 0.0)),
        aside);
    session.path = [walk = round.T_world_camera, start_s, held](double t) {
      return walk(start_s + t) * held;
    };
    return session;
  };
}

SessionPlan hours(const DayOptions& options) {
  const TimedPath round = make_camera_path(options.world);
  return [options, round](int number) {
    const auto seed = static_cast<std::uint64_t>(options.world.seed);
    sim::Random random(
        sim::mix_bits(sim::mix_bits(seed, 6000), static_cast<std::uint64_t>(number)));
    Session session;
    session.world = options.world;
    session.world.frames =
        static_cast<int>(std::lround(options.session_minutes * 60.0 * options.world.fps));
    if (options.light_changes) {
      session.world.light = LightKind::changing;
      session.world.light_seed = 1000 * options.world.seed + number;
      session.world.light_change_s = 300.0;
    }
    session.world.chairs_moved_m =
        random.uniform(-options.furniture_moves_m, options.furniture_moves_m);
    const double start_s = session.world.frames / options.world.fps * number;
    session.path = [walk = round.T_world_camera, start_s](double t) { return walk(start_s + t); };
    return session;
  };
}

}  // namespace ydd
