// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "arrays.h"
#include "options.h"
#include "trajectory.h"
#ifdef YDD_HAS_SIMULATION
#include "ydd/simulation/simulator.h"
#endif

namespace ydd::python {

#ifdef YDD_HAS_SIMULATION
namespace {

/// Frames are rendered when they are asked for.
class Simulation {
 public:
  explicit Simulation(const WorldOptions& world)
      : simulator_(without_gil([&] { return std::make_shared<const Simulator>(world); })) {}

  const Simulator& simulator() const { return *simulator_; }
  SimulatedFrame at(py::ssize_t i) const {
    const py::ssize_t size = simulator_->frame_count();
    if (i < 0) i += size;
    if (i < 0 || i >= size) {
      throw py::index_error("the simulation has " + std::to_string(size) + " frames");
    }
    return without_gil([&] { return simulator_->render(static_cast<int>(i)); });
  }

 private:
  std::shared_ptr<const Simulator> simulator_;
};

struct SimulatedFrames {
  Simulation simulation;
  int next = 0;
};

Simulation simulate(const py::object& options) {
  WorldOptions world;
  OptionTable table;
  world.describe(table);
  set_options(settings_from(options), table);
  return Simulation(world);
}

py::list detections_of(const SimulatedFrame& frame) {
  py::list out;
  for (const SimulatedObject& object : frame.objects) {
    out.append(Detection{object.class_name, 1.0F, object.box});
  }
  return out;
}

Trajectory truth_of(const Simulation& simulation) {
  Trajectory out;
  const Simulator& simulator = simulation.simulator();
  for (int i = 0; i < simulator.frame_count(); ++i) {
    out.poses.push_back({simulator.stamp(i), simulator.pose(i)});
  }
  return out;
}

void bind_simulated_frame(py::module_& module) {
  py::class_<SimulatedFrame>(module, "SimulatedFrame", "A rendered frame and what is true of it.")
      .def_readonly("frame", &SimulatedFrame::frame, "RgbdFrame, for Slam.process()")
      .def_property_readonly(
          "T_world_camera", [](const SimulatedFrame& f) { return matrix_of(f.T_world_camera); },
          "(4, 4) float64; the simulated world: z up, floor at 0, metres")
      .def_property_readonly("detections", &detections_of,
                             "list of Detection: exact boxes of all that is visible")
      .def_property_readonly(
          "mask", [](const SimulatedFrame& f) { return view_of(f.mask); },
          "(height, width) of uint8: number of what moves at some time, 0 elsewhere; read-only, "
          "shared");
}

}  // namespace

void bind_simulation(py::module_& module) {
  bind_simulated_frame(module);
  py::class_<SimulatedFrames>(module, "SimulatedFrames", "The frames of a Simulation in order.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", [](SimulatedFrames& frames) {
        if (frames.next >= frames.simulation.simulator().frame_count()) throw py::stop_iteration();
        return frames.simulation.at(frames.next++);
      });
  py::class_<Simulation>(module, "Simulation",
                         R"(A simulated RGB-D world with exact truth. Made by simulate().

`for seen in simulation` renders a SimulatedFrame at a time, simulation[i] any of them: the same
options give the same bytes.)")
      .def_property_readonly(
          "camera", [](const Simulation& s) { return s.simulator().camera(); },
          "the Camera that it is seen with, for Slam; a copy")
      .def_property_readonly("groundtruth", &truth_of,
                             "Trajectory of all frames, exact, in the simulated world: z up")
      .def("__len__", [](const Simulation& s) { return s.simulator().frame_count(); })
      .def("__getitem__", &Simulation::at, py::arg("index"))
      .def("__iter__", [](const Simulation& s) { return SimulatedFrames{s}; })
      .def("__repr__", [](const Simulation& s) {
        return fmt::format("<ydd_slam.Simulation of {} frames>", s.simulator().frame_count());
      });
  module.def("simulate", &simulate, py::arg("options") = py::none(),
             R"(A simulated sequence, rendered frame by frame as it is asked for.

options  dictionary of what `ydd-slam simulate --set` takes: path (static, xyz, rpy, halfsphere,
         room_loop), people, busy, mover, frames, seed, width, height, depth (exact, kinect), ...)");
}

#else

void bind_simulation(py::module_& module) {
  module.def(
      "simulate",
      [](const py::object& /*options*/) {
        throw Failure("simulate: this module was built without the simulator (libembree-dev)");
      },
      py::arg("options") = py::none(), "Not in this build: it lacks Embree.");
}

#endif

}  // namespace ydd::python
