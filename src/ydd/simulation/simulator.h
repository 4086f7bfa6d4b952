// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ydd/detection/detection.h"
#include "ydd/geometry/se3.h"
#include "ydd/image/rgbd_frame.h"
#include "ydd/simulation/camera_path.h"
#include "ydd/simulation/world_options.h"

namespace ydd {

/// A visible thing in one frame, exactly.
struct SimulatedObject {
  std::string class_name;  ///< person head hand chair cup fan monitor keyboard mouse book thing
  std::string name;        ///< unique: "person0_head"
  int id = 0;              ///< of the whole thing; movers have the ids of the masks, 1 to 255
  bool dynamic = false;    ///< moves in this frame
  bool moved_in_sequence = false;  ///< moves in some frame: what the mask numbers
  Box box;         ///< around its visible pixels; a person's includes head and hands
  int pixels = 0;  ///< visible ones
};

/// A frame and what is true of it.
struct SimulatedFrame {
  RgbdFrame frame;                       ///< what the simulated camera took, with its noise
  SE3 T_world_camera;                    ///< exact; the simulated world: z up, floor at 0, metres
  std::vector<SimulatedObject> objects;  ///< in the order of the scene
  Image<std::uint8_t> mask;              ///< id of what moves at some time, 0: static
};

/// A person or thing that moves at some time, where it is in the world: exactly.
struct SimulatedMover {
  std::string class_name, name;                            ///< as in SimulatedObject
  int id = 0;                                              ///< its value in the masks, 1 to 255
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();      ///< of its bodies; the world's z is up
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();  ///< of that
};

/// A procedural RGB-D world with exact ground truth (see WorldOptions). Frames are random-access:
/// `render(i)` gives the same bytes in any order, on any number of threads.
/// Thread: `render` may run concurrently.
class Simulator {
 public:
  /// Along the path that the options name.
  explicit Simulator(const WorldOptions& options);
  /// Along a path of one's own; with `options.frames` of 0 there are 300.
  Simulator(const WorldOptions& options, CameraPath path);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  int frame_count() const;       ///< Frames of the whole path, or as many as were asked for.
  const Camera& camera() const;  ///< The one that all frames are taken with, without distortion.
  /// Time of a frame; the first is at 1700000000 s, all on whole microseconds.
  Timestamp stamp(int index) const;
  /// T_world_camera of a frame, exact.
  SE3 pose(int index) const;
  /// Everything that moves at some time, whether the camera sees it or not, without heads and
  /// hands.
  std::vector<SimulatedMover> movers(int index) const;
  /// What the sensors of motion say from half a second before the first frame until the last.
  MotionSamples motion_samples() const;
  /// @throws std::logic_error unless 0 <= index < frame_count().
  SimulatedFrame render(int index) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace ydd
