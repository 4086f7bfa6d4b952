// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "slam.h"

namespace ydd::python {
namespace {

constexpr const char* kSlamText = R"(The whole system, picture by picture.

    slam = Slam(Camera.load("tum_fr3"), {"dynamics.variant": "full"})
    for ...:
        frame = slam.process(colour, depth, stamp)
    slam.finish()
    slam.trajectory().save("trajectory.tum")

camera             Camera; depth must be registered to colour
options            dictionary of what `ydd-slam run --set` takes, nested or with dots; see
                   `ydd-slam options`. {"deterministic": True}: two runs give the same bytes, and the
                   same as the program
config             YAML file of options; `options` count more
detector           "default": the network that comes with the program (YDD_DETECTOR names another);
                   None: nobody looks; the name of a detector file, or of recorded boxes (.jsonl); or
                   a function that is called with an RgbdFrame and gives a list of Detection or of
                   (class, box, score). It is called on a thread of its own, beside the extraction of
                   features; what it raises is the cause of the Error of process()
objects            catalogue of classes, as configs/objects.yaml; None: the built-in one
map                a Map, or a map file, to go on with; None: start from nothing. A Map stays as it
                   is: the Slam has a copy of it and of all others of its run
localization_only  use the map without changing it
autosave           map file that is saved every few seconds; None: none
map_key            of all map files that are loaded and saved: as for Map.load
live               frames come from a camera, and none waits. Else a frame waits for a mapper that is
                   further behind than the option mapping_lag_s, in the time of the stamps

One thread at a time may call it; others run while it works (it lets go of the GIL). Every failure
is an Error with one line that tells what to do.)";

std::shared_ptr<RobotFrame> process_arrays(Slam& slam, const py::object& colour,
                                           const py::object& depth, const py::object& stamp,
                                           const py::object& stamp_ns, const py::object& detections,
                                           const py::object& masks) {
  const RgbdFrame frame = frame_from(colour, depth, stamp_from(stamp, stamp_ns), slam.camera());
  return slam.process(frame, detections, masks);
}

void add_imu(Slam& slam, std::int64_t stamp_ns, const Eigen::Vector3d& gyro_rad_s,
             const Eigen::Vector3d& accel_m_s2) {
  slam.add(ImuSample{{stamp_ns}, gyro_rad_s, accel_m_s2});
}

void add_odometry(Slam& slam, std::int64_t stamp_ns, const py::array& T_odom_base) {
  slam.add(OdometryPose{{stamp_ns}, motion_from(T_odom_base, "T_odom_base")});
}

using SlamClass = py::class_<Slam>;

void bind_pictures(SlamClass& slam) {
  slam.def("process", &Slam::process, py::arg("frame"), py::kw_only(),
           py::arg("detections") = py::none(), py::arg("masks") = py::none(),
           R"(The next picture, as an RgbdFrame: nothing is copied.

detections  what is seen in it, in place of asking the detector: a list of Detection or of
            (class, (x0, y0, x1, y1), score)
masks       silhouettes in place of boxes: one (height, width) array of bool or integers, not 0 on
            people, an (N, height, width) array of several, or a list of (class, array). The class decides as with boxes: "person" moves,
            "chair" when somebody moves it; an unknown one never. Both may be given

Gives a Frame. Raises Error when stamps do not rise, when the detector fails, or when a thread inside
has failed; what was tracked before stays.)")
      .def("process", &process_arrays, py::arg("colour"), py::arg("depth"),
           py::arg("stamp") = py::none(), py::kw_only(), py::arg("stamp_ns") = py::none(),
           py::arg("detections") = py::none(), py::arg("masks") = py::none(),
           R"(The same of arrays.

colour  (height, width, 3) of uint8, blue green red, or (height, width) grey; shared where nobody may
        write it (flags.writeable is False), else copied
depth   (height, width) of float32 in metres, or of integers in counts of camera.depth_scale; copied
        as a rule (see RgbdFrame)
stamp   seconds, kept to the microsecond; stamp_ns: exact nanoseconds instead)");
  slam.def("add_imu", &add_imu, py::arg("stamp_ns"), py::arg("gyro_rad_s"), py::arg("accel_m_s2"),
           "A reading of an IMU, (3,) each, in its own frame (option reckoning.T_camera_imu): "
           "before "
           "the first frame that is not earlier.")
      .def("add_odometry", &add_odometry, py::arg("stamp_ns"), py::arg("T_odom_base"),
           "A pose of wheel odometry, (4, 4) (option reckoning.T_camera_base): likewise.");
}

void bind_run(SlamClass& slam) {
  slam.def(
          "finish", &Slam::finish, py::arg("prompt") = false,
          "Works off what waits; with `prompt` interrupts it. Nothing may be processed afterwards.")
      .def("reset", &Slam::reset, "Forgets every map; the next picture starts anew.")
      .def("save", &Slam::save, py::arg("file"),
           "Saves the map as it is now (docs/maps.md), whole or not at all.")
      .def("load", &Slam::load, py::arg("map"),
           "Goes on in a Map or in that of a file instead of the one there is, which stays if that "
           "fails.")
      .def_property("localization_only", &Slam::localization_only, &Slam::set_localization_only,
                    "whether the map is used without being changed")
      .def(
          "trajectory", &Slam::trajectory,
          "Trajectory of the frames in the main map, in its newest state: trajectory.tum of a run.")
      .def("keyframe_trajectory", &Slam::keyframe_trajectory, "The same of its keyframes.")
      .def_property_readonly(
          "map", &Slam::map,
          "Map that the camera is in, as it is now; later frames do not change it")
      .def_property_readonly("loops", &Slam::loops, "how many loops were closed")
      .def_property_readonly("camera", &Slam::camera, "the Camera that it was given; a copy")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Slam& self, const py::object& type, const py::object&,
                          const py::object&) { self.finish(!type.is_none()); });
}

}  // namespace

void bind_slam(py::module_& module) {
  SlamClass slam(module, "Slam", kSlamText);
  slam.def(
      py::init([](const Camera& camera, const py::object& options, const py::object& config,
                  const py::object& detector, const py::object& objects, const py::object& map,
                  bool localization_only, const py::object& autosave, const py::object& map_key,
                  bool live) {
        return std::make_unique<Slam>(Slam::Wish{camera, options, config, detector, objects, map,
                                                 autosave, map_key, localization_only, live});
      }),
      py::arg("camera"), py::arg("options") = py::none(), py::kw_only(),
      py::arg("config") = py::none(), py::arg("detector") = "default",
      py::arg("objects") = py::none(), py::arg("map") = py::none(),
      py::arg("localization_only") = false, py::arg("autosave") = py::none(),
      py::arg("map_key") = py::none(), py::arg("live") = false);
  bind_pictures(slam);
  bind_run(slam);
  py::module_::import("atexit").attr("register")(py::cpp_function(&Slam::close_all));
}

}  // namespace ydd::python
