// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "trajectory.h"
#include "ydd/evaluation/ate.h"
#include "ydd/evaluation/rpe.h"

namespace ydd::python {
namespace {

Trajectory trajectory_from(const py::array& stamps_ns, const py::array& poses) {
  const auto stamps = py::array_t<std::int64_t, py::array::c_style>::ensure(stamps_ns);
  const bool fits = stamps && stamps.ndim() == 1 && poses.ndim() == 3 &&
                    poses.shape(0) == stamps.shape(0) && poses.shape(1) == 4 && poses.shape(2) == 4;
  if (!fits) throw Failure("Trajectory: give (N,) nanoseconds as int64 and (N, 4, 4) poses");
  Trajectory out;
  for (py::ssize_t i = 0; i < stamps.shape(0); ++i) {
    const Timestamp stamp{stamps.at(i)};
    if (!out.poses.empty() && stamp <= out.poses.back().stamp) {
      throw Failure(fmt::format("Trajectory: stamp {} is not later than the one before", i));
    }
    const py::array pose = poses[py::int_(i)];
    out.poses.push_back({stamp, motion_from(pose, fmt::format("Trajectory: pose {}", i))});
  }
  return out;
}

TrajectoryFormat format_of(const std::string& name) {
  if (const auto format = parse_trajectory_format(name)) return *format;
  throw Failure("format: must be tum, kitti or euroc, not " + name);
}

py::array_t<double> poses_of(const Trajectory& trajectory) {
  std::vector<double> values;
  values.reserve(16 * trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> M = pose.T_world_camera.matrix();
    values.insert(values.end(), M.data(), M.data() + 16);
  }
  return taken(std::move(values), 16)
      .reshape({static_cast<py::ssize_t>(trajectory.poses.size()), py::ssize_t{4}, py::ssize_t{4}});
}

template <class Value, class Of>
std::vector<Value> each(const Trajectory& trajectory, Of of) {
  std::vector<Value> out;
  for (const StampedPose& pose : trajectory.poses) out.push_back(of(pose));
  return out;
}

/// A Trajectory, or the name of a file that holds one.
Trajectory trajectory_or_file(const py::object& given) {
  if (py::isinstance<Trajectory>(given)) return given.cast<Trajectory>();
  return {value_of(read_tum_trajectory(py::str(given).cast<std::string>()))};
}

py::array_t<std::int64_t> pairs_of(const std::vector<IndexPair>& pairs) {
  std::vector<std::int64_t> values;
  for (const IndexPair& pair : pairs) {
    values.push_back(static_cast<std::int64_t>(pair.a));
    values.push_back(static_cast<std::int64_t>(pair.b));
  }
  return taken(std::move(values), 2);
}

AteResult ate(const py::object& groundtruth, const py::object& estimate, double max_difference_s,
              bool scale) {
  const AteOptions options{max_difference_s,
                           scale ? AlignmentScale::estimated : AlignmentScale::fixed};
  const Trajectory truth = trajectory_or_file(groundtruth), found = trajectory_or_file(estimate);
  Result<AteResult> error =
      without_gil([&] { return absolute_trajectory_error(truth.poses, found.poses, options); });
  if (error || py::isinstance<Trajectory>(estimate)) return value_of(std::move(error));
  throw Failure(py::str(estimate).cast<std::string>() + ": " + error.error().message);
}

RpeResult rpe(const py::object& groundtruth, const py::object& estimate, double delta,
              const std::string& unit, double max_difference_s, double scale) {
  if (unit != "s" && unit != "frames") throw Failure("unit: must be s or frames, not " + unit);
  RpeOptions options;
  options.delta = delta;
  options.unit = unit == "s" ? RpeUnit::seconds : RpeUnit::frames;
  options.max_difference_s = max_difference_s;
  options.scale = scale;
  const Trajectory truth = trajectory_or_file(groundtruth), found = trajectory_or_file(estimate);
  return without_gil([&] { return relative_pose_error(truth.poses, found.poses, options); });
}

void bind_trajectory(py::module_& module) {
  py::class_<Trajectory>(module, "Trajectory", R"(Where a camera was: poses by rising time.

T_world_camera maps coordinates of the camera frame (x right, y down, z forward) to those of the
world, metres.)")
      .def(py::init(&trajectory_from), py::arg("stamps_ns"), py::arg("poses"),
           "From (N,) int64 nanoseconds and (N, 4, 4) T_world_camera; copied.")
      .def_static(
          "load",
          [](const std::filesystem::path& file) {
            return Trajectory{value_of(read_tum_trajectory(file))};
          },
          py::arg("file"), "Reads a file in TUM's format: stamp tx ty tz qx qy qz qw.")
      .def(
          "text",
          [](const Trajectory& t, const std::string& format) {
            return format_trajectory(t.poses, format_of(format));
          },
          py::arg("format") = "tum", "The text of a file: the same bytes as `ydd-slam run` writes.")
      .def(
          "save",
          [](const Trajectory& t, const std::filesystem::path& file, const std::string& format) {
            value_of(write_trajectory(file, t.poses, format_of(format)));
          },
          py::arg("file"), py::arg("format") = "tum",
          "Writes a file of format tum, kitti or euroc; readers see the old one or all of it.")
      .def("__len__", [](const Trajectory& t) { return t.poses.size(); })
      .def("__repr__",
           [](const Trajectory& t) {
             return fmt::format("<ydd_slam.Trajectory of {} poses>", t.poses.size());
           })
      .def_property_readonly(
          "stamps_ns",
          [](const Trajectory& t) {
            return taken(each<std::int64_t>(t, [](const auto& p) { return p.stamp.ns; }));
          },
          "(N,) int64, nanoseconds")
      .def_property_readonly(
          "stamps",
          [](const Trajectory& t) {
            return taken(each<double>(t, [](const auto& p) { return p.stamp.seconds(); }));
          },
          "(N,) float64, seconds")
      .def_property_readonly("poses", &poses_of, "(N, 4, 4) float64: T_world_camera")
      .def_property_readonly(
          "positions",
          [](const Trajectory& t) {
            return poses_of(t).attr("__getitem__")(
                py::make_tuple(py::ellipsis(), py::slice(0, 3, 1), 3));
          },
          "(N, 3) float64: where the camera was, metres, world");
}

void bind_statistics(py::module_& module) {
  py::class_<ErrorStatistics>(module, "ErrorStatistics",
                              "Summary of a series of errors, in its unit.")
      .def_readonly("count", &ErrorStatistics::count, "how many errors there are")
      .def_readonly("rmse", &ErrorStatistics::rmse, "root of the mean square")
      .def_readonly("mean", &ErrorStatistics::mean, "sum by count")
      .def_readonly("median", &ErrorStatistics::median, "half of them are smaller")
      .def_readonly("std", &ErrorStatistics::sd, "standard deviation about the mean")
      .def_readonly("min", &ErrorStatistics::min, "the smallest")
      .def_readonly("max", &ErrorStatistics::max, "the largest")
      .def("__repr__", [](const ErrorStatistics& s) {
        return fmt::format(
            "<ydd_slam.ErrorStatistics rmse {:.6f}, median {:.6f}, max {:.6f} of {}>", s.rmse,
            s.median, s.max, s.count);
      });
}

void bind_errors(py::module_& module) {
  py::class_<AteResult>(module, "Ate", "Absolute trajectory error; see ate().")
      .def_readonly("statistics_m", &AteResult::statistics_m, "ErrorStatistics of errors_m, metres")
      .def_property_readonly(
          "rmse_m", [](const AteResult& r) { return r.statistics_m.rmse; },
          "root of the mean square error, metres: what papers call the ATE")
      .def_property_readonly(
          "errors_m",
          [](const py::object& self) {
            const auto& errors = self.cast<const AteResult&>().errors_m;
            return view(errors.data(), {static_cast<py::ssize_t>(errors.size())}, {}, self);
          },
          "(P,) float64, metres, read-only: one for each pair")
      .def_property_readonly(
          "pairs", [](const AteResult& r) { return pairs_of(r.pairs); },
          "(P, 2) int64: index of the true pose, of the estimated one")
      .def_property_readonly(
          "T_groundtruth_estimate",
          [](const AteResult& r) { return matrix_of(r.alignment.T_target_source); },
          "(4, 4) float64: the alignment, after `scale`")
      .def_property_readonly(
          "scale", [](const AteResult& r) { return r.alignment.scale; },
          "what the estimate was multiplied by before T_groundtruth_estimate; 1 unless asked for")
      .def("__repr__", [](const AteResult& r) {
        return fmt::format("<ydd_slam.Ate {:.6f} m rmse of {} pairs>", r.statistics_m.rmse,
                           r.statistics_m.count);
      });
  py::class_<RpeResult>(module, "Rpe", "Relative pose error; see rpe().")
      .def_readonly("translation_m", &RpeResult::translation_m,
                    "ErrorStatistics of translation_errors_m, metres over one delta")
      .def_readonly("rotation_deg", &RpeResult::rotation_deg,
                    "ErrorStatistics of rotation_errors_deg, degrees over one delta")
      .def_property_readonly(
          "translation_errors_m",
          [](const py::object& self) {
            const auto& errors = self.cast<const RpeResult&>().translation_errors_m;
            return view(errors.data(), {static_cast<py::ssize_t>(errors.size())}, {}, self);
          },
          "(P,) float64, metres, read-only: one for each pair of poses one delta apart")
      .def_property_readonly(
          "rotation_errors_deg",
          [](const py::object& self) {
            const auto& errors = self.cast<const RpeResult&>().rotation_errors_deg;
            return view(errors.data(), {static_cast<py::ssize_t>(errors.size())}, {}, self);
          },
          "(P,) float64, degrees, read-only: the same pairs")
      .def("__repr__", [](const RpeResult& r) {
        return fmt::format("<ydd_slam.Rpe {:.6f} m, {:.6f} deg rmse of {} pairs>",
                           r.translation_m.rmse, r.rotation_deg.rmse, r.translation_m.count);
      });
}

}  // namespace

void bind_evaluation(py::module_& module) {
  bind_trajectory(module);
  bind_statistics(module);
  bind_errors(module);
  module.def("ate", &ate, py::arg("groundtruth"), py::arg("estimate"), py::kw_only(),
             py::arg("max_difference_s") = 0.02, py::arg("scale") = false,
             R"(Absolute trajectory error after the best alignment, as TUM's benchmark has it.

groundtruth, estimate  Trajectory, or the name of a file in TUM's format
max_difference_s       poses farther apart in time are no pair
scale                  align by Sim(3), for maps without metric scale

Raises Error with fewer than three pairs.)");
  module.def("rpe", &rpe, py::arg("groundtruth"), py::arg("estimate"), py::kw_only(),
             py::arg("delta") = 1.0, py::arg("unit") = "s", py::arg("max_difference_s") = 0.02,
             py::arg("scale") = 1.0,
             R"(Relative pose error: drift over `delta` of `unit` ("s" or "frames").

groundtruth, estimate  Trajectory, or the name of a file in TUM's format
scale                  applied to the estimated motion

Without any pair all figures are 0 and `count` says so.)");
}

}  // namespace ydd::python
