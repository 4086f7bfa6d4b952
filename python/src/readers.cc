// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "options.h"
#include "trajectory.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/sources/source.h"

namespace ydd::python {
namespace {

/// A recording with the camera that it was taken with.
struct OpenSequence {
  std::shared_ptr<const Sequence> sequence;
  Camera camera;
};

OpenSequence open(const std::filesystem::path& path, const py::object& camera,
                  const py::kwargs& kwargs) {
  SequenceOptions options;
  OptionTable table;
  options.describe(table);
  set_options(settings_from(kwargs), table);
  const bool given = py::isinstance<Camera>(camera);
  const std::string name = given || camera.is_none() ? "" : py::str(camera).cast<std::string>();
  OpenSequence out;
  if (given) out.camera = camera.cast<Camera>();
  without_gil([&] {
    Recording recording = value_of(open_recording(path, options));
    if (!given) out.camera = value_of(find_camera(recording, name));
    out.sequence =
        std::make_shared<const Sequence>(value_of(Sequence::of(std::move(recording), options)));
  });
  return out;
}

py::object groundtruth_of(const OpenSequence& opened) {
  const auto& truth = opened.sequence->groundtruth();
  if (!truth) return py::none();
  return py::cast(Trajectory{value_of(without_gil([&] { return truth->read(); }))});
}

RgbdFrame frame_at(const OpenSequence& opened, py::ssize_t i) {
  const auto size = static_cast<py::ssize_t>(opened.sequence->size());
  if (i < 0) i += size;
  if (i < 0 || i >= size)
    throw py::index_error("the sequence has " + std::to_string(size) + " frames");
  return value_of(without_gil(
      [&] { return opened.sequence->read(static_cast<std::size_t>(i), opened.camera); }));
}

/// The frames in order, decoded ahead on another thread.
class Frames {
 public:
  Frames(const OpenSequence& opened, bool strict)
      : source_(std::make_unique<FrameSource>(*opened.sequence, opened.camera)), strict_(strict) {}
  ~Frames() {
    const py::gil_scoped_release release;
    source_.reset();
  }
  Frames(Frames&&) = default;
  Frames& operator=(Frames&&) = delete;

  RgbdFrame next() {
    for (;; ++index_) {
      std::optional<Result<RgbdFrame>> frame = without_gil([&] { return source_->next(); });
      if (!frame) throw py::stop_iteration();
      if (*frame || strict_) {
        ++index_;
        return value_of(*std::move(frame));
      }
      log::warning("frame {}: {}; skipped", index_, frame->error().message);
    }
  }

 private:
  std::unique_ptr<FrameSource> source_;
  bool strict_;
  std::int64_t index_ = 0;
};

py::array_t<std::int64_t> stamps_of(const OpenSequence& opened) {
  std::vector<std::int64_t> stamps;
  for (const SequenceEntry& entry : opened.sequence->entries()) stamps.push_back(entry.stamp.ns);
  return taken(std::move(stamps));
}

}  // namespace

void bind_readers(py::module_& module) {
  py::class_<Frames>(module, "Frames", "The frames of a Sequence in order; see Sequence.frames().")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &Frames::next);
  py::class_<OpenSequence>(module, "Sequence",
                           R"(A recording: colour and depth in pairs. Made by open_sequence().

`for frame in sequence` gives an RgbdFrame each, decoded ahead on another thread; sequence[i] decodes
one. Pictures are read when they are wanted.)")
      .def_property_readonly(
          "name", [](const OpenSequence& s) { return s.sequence->name(); }, "of the folder or file")
      .def_readonly("camera", &OpenSequence::camera, "the Camera that it was taken with")
      .def_property_readonly("groundtruth", &groundtruth_of,
                             "true poses of the colour camera as a Trajectory; None: it has none")
      .def_property_readonly("stamps_ns", &stamps_of, "(N,) int64: of the colour pictures")
      .def("__len__", [](const OpenSequence& s) { return s.sequence->size(); })
      .def("__getitem__", &frame_at, py::arg("index"))
      .def(
          "__iter__", [](const OpenSequence& s) { return Frames(s, false); }, "frames()")
      .def(
          "frames", [](const OpenSequence& s, bool strict) { return Frames(s, strict); },
          py::arg("strict") = false,
          "An iterator over the frames. One that cannot be read is skipped with a line on standard "
          "error, as `ydd-slam run` does; with `strict` it raises Error, and next() goes on after "
          "it.")
      .def("__repr__", [](const OpenSequence& s) {
        return fmt::format("<ydd_slam.Sequence '{}' of {} frames>", s.sequence->name(),
                           s.sequence->size());
      });
  module.def("open_sequence", &open, py::arg("path"), py::arg("camera") = py::none(),
             R"(Opens a recording of any kind that `ydd-slam run` takes: docs/data.md lists them.

path    folder or file
camera  a Camera, the name of a file or preset; None: as the recording tells

Further keywords are the options `sequence.*` of `ydd-slam options`: max_difference_s, first_frame,
max_frames, associations, depth_offset, source, topic_colour, ...

No picture is decoded yet. Raises Error with the line that the program would print.)");
}

}  // namespace ydd::python
