// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/accidents.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ydd/simulation/random.h"

namespace ydd {
namespace {

constexpr double kWrong_m = 0.10;  // farther off than this is not found again

CameraPath as_walked(const CameraPath& walk) { return walk; }
FrameEdit as_seen(double, double, double) { return {}; }

/// Stops where it is until the way is free.
CameraPath waits(const CameraPath& walk) {
  return [walk](double t) { return walk(std::min(t, 6.0) + std::max(t - 8.8, 0.0)); };
}

/// Eight seconds on, then carried back to where it was three seconds after the start.
CameraPath to_seen_place(const CameraPath& walk) {
  return [walk](double t) { return walk(t < 8.0 ? t : t - 5.0); };
}

/// Carried a third of a round ahead, from where it walks on until it meets its own track.
CameraPath to_unseen_place(const CameraPath& walk) {
  return [walk](double t) { return walk(t < 5.0 ? t : t + 6.0); };
}

/// Turns round within half a second, looks the other way for one, and turns back.
CameraPath turned_away(const CameraPath& walk) {
  return [walk](double t) {
    const double turned =
        std::clamp((t - 6.0) / 0.5, 0.0, 1.0) * std::clamp((8.0 - t) / 0.5, 0.0, 1.0);
    const Eigen::Vector3d turn(0.0, 0.9 * std::numbers::pi * turned, 0.0);
    return walk(std::min(t, 6.0) + std::max(t - 8.0, 0.0)) * SE3(so3_exp(turn), {0, 0, 0});
  };
}

/// Turns right round within two seconds: 180 degrees a second, and on.
CameraPath turned_round(const CameraPath& walk) {
  return [walk](double t) {
    const double share = std::clamp((t - 6.0) / 2.0, 0.0, 1.0);
    const double smooth = share * share * (3.0 - 2.0 * share);
    const Eigen::Vector3d turn(0.0, 2.0 * std::numbers::pi * smooth, 0.0);
    return walk(std::min(t, 6.0) + std::max(t - 8.0, 0.0)) * SE3(so3_exp(turn), {0, 0, 0});
  };
}

bool within(const SimulatedFrame& frame, double fps, double from_s, double until_s) {
  const double time_s = static_cast<double>(frame.frame.index) / fps;
  return time_s >= from_s && time_s < until_s;
}

/// A black picture without depth.
FrameEdit covered(double fps, double from_s, double until_s) {
  return [=](SimulatedFrame& frame) {
    if (!within(frame, fps, from_s, until_s)) return;
    const int w = frame.frame.grey.width(), h = frame.frame.grey.height();
    const auto n = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    frame.frame.grey = GreyImage(w, h, std::vector<std::uint8_t>(n, 8));
    frame.frame.colour = ColourImage(w, h, std::vector<Bgr>(n, Bgr{8, 8, 8}));
    frame.frame.depth_m = DepthImage(w, h, std::vector<float>(n, 0.0F));
    frame.objects.clear();
  };
}

/// A person so close that there is nothing else: a picture rich in corners that moves as a whole,
/// with the box that a detector gives.
FrameEdit crowded(double fps, double from_s, double until_s) {
  return [=](SimulatedFrame& frame) {
    if (!within(frame, fps, from_s, until_s)) return;
    const int w = frame.frame.grey.width(), h = frame.frame.grey.height();
    std::vector<std::uint8_t> grey;
    std::vector<Bgr> colour;
    const int shift = static_cast<int>(frame.frame.index) * 7;
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const auto cell =
            static_cast<std::uint64_t>((x + shift) / 9) * 4099U + static_cast<std::uint64_t>(y / 9);
        const auto value =
            static_cast<std::uint8_t>(40 + 170 * sim::unit_float(sim::mix_bits(cell)));
        grey.push_back(value);
        colour.push_back({value, value, value});
      }
    }
    frame.frame.grey = GreyImage(w, h, std::move(grey));
    frame.frame.colour = ColourImage(w, h, std::move(colour));
    frame.frame.depth_m = DepthImage(
        w, h, std::vector<float>(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.9F));
    SimulatedObject person;
    person.class_name = "person";
    person.box = {0.0F, 0.0F, static_cast<float>(w), static_cast<float>(h)};
    frame.objects = {person};
  };
}

const Accident kAccidents[] = {
    {"lens covered for 1 s", 6.0, 7.0, 10.0, &as_walked, &covered},
    {"stops before people who hide everything for 2 s", 6.0, 8.0, 10.0, &waits, &crowded},
    {"turned away for 2 s and back", 6.0, 8.0, 10.0, &turned_away, &as_seen},
    {"kidnapped to a place already seen", 8.0, 8.0, 11.0, &to_seen_place, &as_seen},
    {"kidnapped to an unseen place, walks on to a seen one", 5.0, 5.0, 22.0, &to_unseen_place,
     &as_seen},
    {"lens covered for 5 s while walking", 6.0, 11.0, 16.0, &as_walked, &covered},
    {"people hide everything for 5 s while walking", 6.0, 11.0, 16.0, &as_walked, &crowded},
    {"turns right round in 2 s", 6.0, 8.0, 12.0, &turned_round, &as_seen},
};

double error_m(const SimulatedRun& run, std::size_t i) {
  const SE3 T_true_world =
      run.steps.front().T_true_camera * run.steps.front().T_world_camera.inverse();
  return (T_true_world.translation() +
          T_true_world.rotation() * run.steps[i].T_world_camera.translation() -
          run.steps[i].T_true_camera.translation())
      .norm();
}

}  // namespace

std::span<const Accident> accidents() { return kAccidents; }

AccidentOutcome outcome_of(const SimulatedRun& run, const Accident& accident, double fps) {
  AccidentOutcome out;
  out.ate_m = run.ate_m();
  out.with_pose_share = static_cast<double>(run.trajectory.size()) /
                        static_cast<double>(std::max<std::size_t>(1, run.steps.size()));
  for (const CheckedLoop& loop : run.loops) {
    if (loop.report.merged && !loop.is_false()) out.merged = true;
    if (loop.is_false()) out.wrong = true;
  }
  const auto end = static_cast<std::size_t>(std::lround(accident.until_s * fps));
  for (std::size_t i = end; i < run.steps.size(); ++i) {
    if (run.steps[i].state != TrackingState::tracking || error_m(run, i) > kWrong_m) continue;
    out.frames = static_cast<int>(i - end);
    break;
  }
  const std::size_t last = run.steps.size() - 1;
  if (out.frames && error_m(run, last) > 3.0 * kWrong_m) out.wrong = true;
  return out;
}

Result<AccidentOutcome> suffer(const Accident& accident, WorldOptions world, SystemOptions options,
                               Senses senses) {
  const CameraPath walk = make_camera_path(world).T_world_camera;
  world.frames = static_cast<int>(accident.length_s * world.fps);
  if (senses != Senses::imu && senses != Senses::both) world.sensors.imu_hz = 0;
  if (senses != Senses::wheels && senses != Senses::both) world.sensors.odometry_hz = 0;
  options.reckoning.T_camera_imu = simulated_mounting().T_camera_imu;
  options.reckoning.T_camera_base = simulated_mounting().T_camera_base;
  const Simulator simulator(world, accident.path(walk));
  const Result<SimulatedRun> run =
      run_simulated(simulator, options, accident.edit(world.fps, accident.from_s, accident.until_s),
                    {}, simulator.motion_samples());
  if (!run) return run.error();
  return outcome_of(*run, accident, world.fps);
}

}  // namespace ydd
