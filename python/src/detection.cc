// SPDX-License-Identifier: Apache-2.0
#include "detection.h"

#include <array>
#include <optional>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/given_detections.h"
#include "ydd/detection/recorded_detections.h"

namespace ydd::python {
namespace {

using Sides = std::array<float, 4>;

Detection detection_from(std::string class_name, const std::optional<Sides>& box, float score,
                         const py::object& mask, bool sure = true) {
  Detection out{std::move(class_name), score, {}};
  out.sure = sure;
  if (box) out.box = {(*box)[0], (*box)[1], (*box)[2], (*box)[3]};
  if (!mask.is_none()) {
    out.mask = mask_from(array_from(mask, "mask"));
    if (const auto round = box_round(out.mask); round && !box) out.box = *round;
  }
  if (!box && mask.is_none()) throw Failure("Detection: give a box or a mask");
  return out;
}

/// One silhouette, or several on each other.
Detections people_from(const py::array& masks) {
  if (masks.ndim() != 3) return {detection_from("person", std::nullopt, 1.0F, masks)};
  Detections out;
  for (const py::handle mask : masks) {
    out.push_back(
        detection_from("person", std::nullopt, 1.0F, py::reinterpret_borrow<py::object>(mask)));
  }
  return out;
}

/// What a tuple (class, box) or (class, box, score) means; nothing: it is none.
std::optional<Detection> detection_of_tuple(const py::handle& item) {
  if (!py::isinstance<py::tuple>(item) && !py::isinstance<py::list>(item)) return std::nullopt;
  const auto parts = item.cast<py::sequence>();
  if (parts.size() != 2 && parts.size() != 3) return std::nullopt;
  try {
    const auto score = parts.size() == 3 ? parts[2].cast<float>() : 1.0F;
    return detection_from(parts[0].cast<std::string>(), parts[1].cast<Sides>(), score, py::none());
  } catch (const py::cast_error&) {
    return std::nullopt;
  }
}

std::string text_of(const Detection& d) {
  return fmt::format("<ydd_slam.Detection '{}' {:.2f} [{:.0f}, {:.0f}, {:.0f}, {:.0f}]{}>",
                     d.class_name, d.score, d.box.x0, d.box.y0, d.box.x1, d.box.y1,
                     d.mask.empty() ? "" : " with mask");
}

/// The type of an exception and its text, in one line.
std::string line_of(const py::error_already_set& raised) {
  std::string text =
      fmt::format("{}: {}", py::str(raised.type().attr("__name__")).cast<std::string>(),
                  py::str(raised.value()).cast<std::string>());
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

/// Wraps a detector that is written in C++.
class LoadedDetector {
 public:
  explicit LoadedDetector(const std::filesystem::path& file)
      : detector_(without_gil([&] { return value_of(make_detector(file)); })) {}
  Detections detect(const RgbdFrame& frame) {
    if (busy_) throw Failure("this detector is looking at a picture in another thread");
    const Busy busy(busy_);
    return value_of(without_gil([&] { return detector_->detect(frame); }));
  }

 private:
  std::unique_ptr<Detector> detector_;
  bool busy_ = false;
};

}  // namespace

Detections detections_from(const py::handle& given, const std::string& source) {
  if (!py::isinstance<py::sequence>(given) || py::isinstance<py::str>(given)) {
    throw Failure(source + ": must be a list of Detection or of (class, box, score)");
  }
  Detections out;
  for (const py::handle item : given.cast<py::sequence>()) {
    if (py::isinstance<Detection>(item)) {
      out.push_back(item.cast<Detection>());
    } else if (auto detection = detection_of_tuple(item)) {
      out.push_back(*std::move(detection));
    } else {
      throw Failure(fmt::format("{}: item {} is no Detection nor (class, (x0, y0, x1, y1), score)",
                                source, out.size()));
    }
  }
  return out;
}

Detections masks_from(const py::handle& given) {
  if (py::isinstance<py::array>(given) || py::hasattr(given, "__array__")) {
    return people_from(array_from(given, "masks"));
  }
  if (!py::isinstance<py::sequence>(given) || py::isinstance<py::str>(given)) {
    throw Failure("masks: must be an array, or a list of (class, array)");
  }
  Detections out;
  for (const py::handle item : given.cast<py::sequence>()) {
    const bool pair = py::isinstance<py::tuple>(item) && py::len(item) == 2;
    const auto parts = pair ? item.cast<py::tuple>() : py::make_tuple(0, 0);
    if (!py::isinstance<py::str>(parts[0]) || !py::hasattr(parts[1], "__array__")) {
      throw Failure(fmt::format("masks: item {} is no (class, array)", out.size()));
    }
    out.push_back(detection_from(parts[0].cast<std::string>(), std::nullopt, 1.0F, parts[1]));
  }
  return out;
}

std::shared_ptr<PythonLook> make_look(py::function function) {
  return {new PythonLook{std::move(function), {}}, [](PythonLook* look) {
            if (Py_IsInitialized() == 0) return;  // the interpreter has gone
            const py::gil_scoped_acquire acquire;
            delete look;
          }};
}

Result<Detections> CallableDetector::detect(const RgbdFrame& frame) {
  Result<Detections> found = ask(frame);
  if (!found) return found.error();
  return given_detections(*std::move(found), catalogue_, frame.grey.width(), frame.grey.height(),
                          "detector");
}

Result<Detections> CallableDetector::ask(const RgbdFrame& frame) {
  const py::gil_scoped_acquire acquire;
  try {
    return detections_from(look_->function(frame), "detector");
  } catch (const py::error_already_set& raised) {
    look_->raised = raised.value();
    return Error{"detector: " + line_of(raised)};
  } catch (const std::exception& wrong) {
    return Error{wrong.what()};
  }
}

void bind_detection(py::module_& module) {
  py::class_<Detection>(module, "Detection", R"(One object that a detector saw.

class_name  as in the object catalogue: "person", "head", "hand", "chair", ... A class that it does
            not know never moves.
box         (x0, y0, x1, y1) in pixels of the colour image, [x0, x1) x [y0, y1)
score       confidence in [0, 1]
sure        whether that is enough to tell somebody that it is there; if not, its points are left out
            all the same
mask        None, or (height, width) of bool or integers, not 0 where the object is seen; of the size
            of the image. It is copied. It gives the box, and says in place of box and depth range
            which points lie on the object.)")
      .def(py::init(&detection_from), py::arg("class_name"), py::arg("box") = py::none(),
           py::arg("score") = 1.0F, py::arg("mask") = py::none(), py::arg("sure") = true)
      .def_readonly("class_name", &Detection::class_name, "as it was given")
      .def_readonly("score", &Detection::score, "confidence in [0, 1]")
      .def_readonly("sure", &Detection::sure,
                    "whether the score is enough to tell somebody that it is there")
      .def_property_readonly(
          "box",
          [](const Detection& d) { return py::make_tuple(d.box.x0, d.box.y0, d.box.x1, d.box.y1); },
          "(x0, y0, x1, y1), pixels")
      .def_property_readonly(
          "mask",
          [](const Detection& d) -> py::object {
            return d.mask.empty() ? py::none() : py::object(view_of(d.mask));
          },
          "(height, width) of uint8, read-only, shared; None without one")
      .def("__repr__", &text_of);

  py::class_<LoadedDetector>(module, "Detector",
                             R"(A detector file (docs/detector.md): one or several networks.

Slam takes the name of such a file itself; this is for looking at pictures alone.)")
      .def(py::init<const std::filesystem::path&>(), py::arg("file"))
      .def("__call__", &LoadedDetector::detect, py::arg("frame"),
           "What it sees in an RgbdFrame: a list of Detection by falling score.");

  py::class_<RecordedDetector>(module, "RecordedDetections",
                               "Boxes of a recording (detections.jsonl), found by time.")
      .def(py::init([](const std::filesystem::path& file) {
             return RecordedDetector(
                 without_gil([&] { return value_of(DetectionRecording::read(file)); }),
                 file.string());
           }),
           py::arg("file"))
      .def(
          "__call__",
          [](RecordedDetector& d, const RgbdFrame& frame) { return value_of(d.detect(frame)); },
          py::arg("frame"), "The boxes of an RgbdFrame: a list of Detection by falling score.");
}

}  // namespace ydd::python
