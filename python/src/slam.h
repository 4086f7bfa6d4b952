// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "detection.h"
#include "map.h"
#include "trajectory.h"
#include "ydd/robot/robot_slam.h"

namespace ydd::python {

/// A RobotSlam whose map frame is the world, one call at a time: a second thread that calls
/// meanwhile is told so. All of it is called with the GIL, and lets go of it while it works.
class Slam {
 public:
  /// What Python gives; see the text of the class.
  struct Wish {
    Camera camera;
    py::object options, config, detector, objects, map, autosave, map_key;
    bool localization_only = false, live = false;
  };
  explicit Slam(const Wish& wish);
  ~Slam();
  /// Ends the threads of every Slam that there still is: before the interpreter goes, without which
  /// a detector in Python cannot return.
  static void close_all();
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  std::shared_ptr<RobotFrame> process(const RgbdFrame& frame, const py::object& detections,
                                      const py::object& masks);
  void add(const ImuSample& sample);
  void add(const OdometryPose& pose);
  void finish(bool prompt);
  void reset();
  void save(const std::filesystem::path& file);
  void load(const py::object& map);
  void set_localization_only(bool on);
  bool localization_only();

  Trajectory trajectory();
  Trajectory keyframe_trajectory();
  Map map();
  int loops();
  const Camera& camera() const { return camera_; }

 private:
  /// `work`, without the GIL, unless something else is being worked on.
  template <class Work>
  auto once(Work&& work) -> decltype(work());
  [[noreturn]] void fail(const Error& error) const;
  void close();

  Camera camera_;
  std::unique_ptr<RobotSlam> slam_;   ///< null: closed
  std::shared_ptr<PythonLook> look_;  ///< a detector in Python; null: none
  bool busy_ = false;                 ///< under the GIL
  bool finished_ = false;
};

template <class Work>
auto Slam::once(Work&& work) -> decltype(work()) {
  if (!slam_) throw Failure("this Slam is closed: Python ends");
  if (busy_) throw Failure("this Slam is at work in another thread: one call at a time");
  const Busy busy(busy_);
  return without_gil(std::forward<Work>(work));
}

}  // namespace ydd::python
