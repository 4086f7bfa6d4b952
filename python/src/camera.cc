// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "arrays.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/camera_presets.h"

namespace ydd::python {
namespace {

py::array_t<double> pinhole_of(const Camera& camera) {
  py::array_t<double> out({3, 3});
  auto K = out.mutable_unchecked<2>();
  for (int i = 0; i < 9; ++i) K(i / 3, i % 3) = i == 8 ? 1.0 : 0.0;
  K(0, 0) = camera.fx_px;
  K(1, 1) = camera.fy_px;
  K(0, 2) = camera.cx_px;
  K(1, 2) = camera.cy_px;
  return out;
}

Camera camera_from(const py::kwargs& values) {
  Camera camera;
  py::object self = py::cast(&camera, py::return_value_policy::reference);
  for (const auto& [key, value] : values) {
    if (!py::hasattr(self, key)) {
      throw Failure(fmt::format("camera: it has no '{}'; see help(ydd_slam.Camera)",
                                key.cast<std::string>()));
    }
    py::setattr(self, key, value);
  }
  value_of(check_camera(camera));
  return camera;
}

}  // namespace

namespace {

void bind_picture(py::module_& module) {
  py::class_<RgbdFrame>(
      module, "RgbdFrame",
      R"(One picture of an RGB-D camera: colour, and depth registered to it, of the same size.

Its arrays are read-only views: they share its memory and keep it alive.

    RgbdFrame(colour, depth, camera, stamp=None, stamp_ns=None, index=0)

colour    (height, width, 3) of uint8, blue green red as OpenCV has it, or (height, width) grey.
          An array that nobody may write (flags.writeable is False) is shared, so it must not change
          any more; any other is copied.
          What has __array__, as a tensor in the processor's memory, is an array here.
depth     (height, width) of float32 in metres, or of integers in counts of camera.depth_scale.
          0, what is not finite and what lies outside the camera's limits is no reading: it becomes
          0. Shared where nothing needs to and nobody may write it (float32); else copied.
stamp     seconds, kept to the microsecond; stamp_ns: exact nanoseconds instead)")
      .def(py::init([](const py::object& colour, const py::object& depth, const Camera& camera,
                       const py::object& stamp, const py::object& stamp_ns, std::int64_t index) {
             RgbdFrame frame = frame_from(colour, depth, stamp_from(stamp, stamp_ns), camera);
             frame.index = index;
             return frame;
           }),
           py::arg("colour"), py::arg("depth"), py::arg("camera"), py::arg("stamp") = py::none(),
           py::arg("stamp_ns") = py::none(), py::arg("index") = 0)
      .def_readonly("index", &RgbdFrame::index, "position in the sequence, counts skipped ones too")
      .def_property_readonly(
          "stamp", [](const RgbdFrame& f) { return f.stamp.seconds(); }, "seconds")
      .def_property_readonly(
          "stamp_ns", [](const RgbdFrame& f) { return f.stamp.ns; }, "nanoseconds, exact")
      .def_property_readonly(
          "colour", [](const RgbdFrame& f) { return view_of(f.colour); },
          "(height, width, 3) of uint8, blue green red; read-only, shared")
      .def_property_readonly(
          "grey", [](const RgbdFrame& f) { return view_of(f.grey); },
          "(height, width) of uint8; read-only, shared")
      .def_property_readonly(
          "depth_m", [](const RgbdFrame& f) { return view_of(f.depth_m); },
          "(height, width) of float32: metres along the optical axis, 0 is no reading; read-only, "
          "shared")
      .def("__repr__", [](const RgbdFrame& f) {
        return fmt::format("<ydd_slam.RgbdFrame {} at {} s, {} x {} px>", f.index,
                           format_timestamp(f.stamp), f.colour.width(), f.colour.height());
      });
}

}  // namespace

void bind_camera(py::module_& module) {
  py::class_<Camera>(
      module, "Camera",
      R"(A calibrated RGB-D camera: pinhole, with distortion k1 k2 p1 p2 k3 as OpenCV has it.

Camera frame: x right, y down, z forward, metres. Pixel centres are at whole numbers.
Depth images are registered to the colour image and of its size.

    Camera(width_px=640, height_px=480, fx_px=525, fy_px=525, cx_px=319.5, cy_px=239.5,
           k1=0, k2=0, p1=0, p2=0, k3=0, depth_scale=5000, min_depth_m=0.1, max_depth_m=10,
           fps=30, baseline_m=0.15, name="camera"))")
      .def(py::init(&camera_from),
           "Any of the attributes by name; the others have the defaults above.")
      .def_readwrite("name", &Camera::name, "what it is called; of no consequence")
      .def_readwrite("width_px", &Camera::width_px, "of its pictures")
      .def_readwrite("height_px", &Camera::height_px, "of its pictures")
      .def_readwrite("fx_px", &Camera::fx_px, "focal length along x")
      .def_readwrite("fy_px", &Camera::fy_px, "focal length along y")
      .def_readwrite("cx_px", &Camera::cx_px, "principal point; the middle of the first pixel is 0")
      .def_readwrite("cy_px", &Camera::cy_px, "likewise, downwards")
      .def_readwrite("k1", &Camera::k1, "radial distortion")
      .def_readwrite("k2", &Camera::k2, "radial distortion")
      .def_readwrite("p1", &Camera::p1, "tangential distortion")
      .def_readwrite("p2", &Camera::p2, "tangential distortion")
      .def_readwrite("k3", &Camera::k3, "radial distortion")
      .def_readwrite("depth_scale", &Camera::depth_scale, "value of one metre in depth of uint16")
      .def_readwrite("min_depth_m", &Camera::min_depth_m, "nearer readings are none")
      .def_readwrite("max_depth_m", &Camera::max_depth_m, "farther readings are none")
      .def_readwrite("fps", &Camera::fps,
                     "nominal pictures a second: how soon a frame must become a keyframe")
      .def_readwrite("baseline_m", &Camera::baseline_m,
                     "of the virtual stereo pair that weighs depth against pixels")
      .def_property_readonly("K", &pinhole_of, "(3, 3) float64: the matrix of the pinhole, a copy")
      .def_static(
          "load",
          [](const py::object& name) {
            return value_of(find_camera("", py::str(name).cast<std::string>()));
          },
          py::arg("name"),
          "The camera of a file (YAML or JSON of many programs) or of a preset: see presets().")
      .def_static(
          "presets",
          [] {
            py::list names;
            for (const Camera& camera : camera_presets()) names.append(camera.name);
            return names;
          },
          "Names of the cameras that need no file.")
      .def("__repr__", [](const Camera& c) {
        return fmt::format("<ydd_slam.Camera '{}' {} x {} px, fx {:.1f}>", c.name, c.width_px,
                           c.height_px, c.fx_px);
      });
  bind_picture(module);
}

}  // namespace ydd::python
