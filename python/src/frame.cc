// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "frame.h"
#include "ydd/robot/robot_slam.h"

namespace ydd::python {
namespace {

using SharedFrame = std::shared_ptr<const RobotFrame>;

/// The points that were rejected; arrays over them keep the frame alive.
struct RejectedPoints {
  SharedFrame frame;
  const std::vector<RejectedPoint>& points() const { return frame->report.filtered->rejected; }
};

/// A member of each element of a vector, `width` values side by side.
template <class Value, class Element, class Owner>
py::array_t<Value> column(const std::vector<Element>& elements, const Value* first,
                          const std::shared_ptr<const Owner>& owner, py::ssize_t width = 1) {
  Shape shape{static_cast<py::ssize_t>(elements.size())};
  Shape strides{sizeof(Element)};
  if (width > 1) {
    shape.push_back(width);
    strides.push_back(sizeof(Value));
  }
  static const Value nothing{};
  return view(elements.empty() ? &nothing : first, shape, strides, keeper_of(owner));
}

// x and y of a keypoint lie side by side: they are seen as one row of two.
static_assert(offsetof(Keypoint, y_px) == offsetof(Keypoint, x_px) + sizeof(float));

void bind_what_was_found(py::class_<KeptPoints>& kept) {
  kept.def_property_readonly(
          "octave",
          [](const KeptPoints& p) {
            const auto& points = p.features->keypoints;
            return column(points, &points.data()->octave, p.features);
          },
          "(N,) of int32: level of the pyramid")
      .def_property_readonly(
          "angle_rad",
          [](const KeptPoints& p) {
            const auto& points = p.features->keypoints;
            return column(points, &points.data()->angle_rad, p.features);
          },
          "(N,) of float32: direction in which it is turned, radians, x towards y")
      .def_property_readonly(
          "descriptors",
          [](const KeptPoints& p) {
            const auto& bits = p.features->descriptors;
            return column(bits, reinterpret_cast<const std::uint8_t*>(bits.data()), p.features,
                          sizeof(Descriptor));
          },
          "(N, 32) of uint8: 256 bits (ORB)")
      .def_property_readonly(
          "map_points",
          [](const KeptPoints& p) {
            std::vector<std::int64_t> ids;
            for (const MapPointId id : *p.points) ids.push_back(number_of(id));
            return taken(std::move(ids));
          },
          "(N,) of int64: the Map.point_ids that they were found as, -1: none; a copy");
}

void bind_kept(py::module_& module) {
  py::class_<KeptPoints> kept(
      module, "KeptPoints",
      R"(Feature points that were judged static: what tracking and the map see.

Arrays of one entry for each point, read-only views that keep alive what they show.)");
  kept.def("__len__", [](const KeptPoints& p) { return p.features->size(); })
      .def("__repr__",
           [](const KeptPoints& p) {
             return fmt::format("<ydd_slam.KeptPoints, {} of them>", p.features->size());
           })
      .def_property_readonly(
          "pixels",
          [](const KeptPoints& p) {
            const auto& points = p.features->keypoints;
            return column(points, &points.data()->x_px, p.features, 2);
          },
          "(N, 2) of float32: x, y in the image as it was taken")
      .def_property_readonly(
          "undistorted_px",
          [](const KeptPoints& p) {
            const auto& points = p.features->undistorted_px;
            return column(points, reinterpret_cast<const float*>(points.data()), p.features, 2);
          },
          "(N, 2) of float32: where an ideal lens would have seen them")
      .def_property_readonly(
          "depth_m",
          [](const KeptPoints& p) {
            return column(p.features->depth_m, p.features->depth_m.data(), p.features);
          },
          "(N,) of float32: metres along the optical axis; 0: no reading");
  bind_what_was_found(kept);
}

void bind_rejected(py::module_& module) {
  py::class_<RejectedPoints>(
      module, "RejectedPoints",
      R"(Feature points that were judged to lie on something that moves: nothing else uses them.

Arrays of one entry for each point, read-only views that keep the frame alive.)")
      .def("__len__", [](const RejectedPoints& p) { return p.points().size(); })
      .def("__repr__",
           [](const RejectedPoints& p) {
             return fmt::format("<ydd_slam.RejectedPoints, {} of them>", p.points().size());
           })
      .def_property_readonly(
          "pixels",
          [](const RejectedPoints& p) {
            return column(p.points(), &p.points().data()->keypoint.x_px, p.frame, 2);
          },
          "(N, 2) of float32: x, y in the image as it was taken")
      .def_property_readonly(
          "depth_m",
          [](const RejectedPoints& p) {
            return column(p.points(), &p.points().data()->depth_m, p.frame);
          },
          "(N,) of float32: metres along the optical axis; 0: no reading")
      .def_property_readonly(
          "rule",
          [](const RejectedPoints& p) {
            const auto* const rules =
                reinterpret_cast<const std::uint8_t*>(&p.points().data()->rule);
            return column(p.points(), rules, p.frame);
          },
          "(N,) of uint8: index into ydd_slam.RULES")
      .def_property_readonly(
          "rules",
          [](const RejectedPoints& p) {
            py::list names;
            for (const RejectedPoint& point : p.points()) names.append(to_string(point.rule));
            return names;
          },
          "The names of the rules, one for each point");
}

struct SeenObject {
  ObjectJudgement judged;
  std::string class_name;
};

void bind_seen_object(py::module_& module) {
  py::class_<SeenObject>(module, "SeenObject",
                         "What was found out about one detection that may move.")
      .def_readonly("class_name", &SeenObject::class_name, "as the detector named it")
      .def_property_readonly(
          "kind", [](const SeenObject& o) { return to_string(o.judged.subcategory); },
          "what the object catalogue makes of the class, as in configs/objects.yaml: 'person', ...")
      .def_property_readonly(
          "box",
          [](const SeenObject& o) {
            const Box& b = o.judged.box;
            return py::make_tuple(b.x0, b.y0, b.x1, b.y1);
          },
          "(x0, y0, x1, y1), pixels")
      .def_property_readonly(
          "moves", [](const SeenObject& o) { return o.judged.rule != Rule::kept; },
          "whether points on it are rejected")
      .def_property_readonly(
          "rule", [](const SeenObject& o) { return to_string(o.judged.rule); },
          "the one of ydd_slam.RULES by which points on it are rejected; 'kept': none are")
      .def_property_readonly(
          "depth_m", [](const SeenObject& o) { return o.judged.depth_m; },
          "of its surface, metres; None: not measured")
      .def_property_readonly(
          "depth_range_m",
          [](const SeenObject& o) -> py::object {
            if (!o.judged.range) return py::none();
            return py::make_tuple(o.judged.range->min_m, o.judged.range->max_m);
          },
          "(least, largest) depth of the points that go, metres; None: all of them, or none")
      .def_property_readonly(
          "log_odds", [](const SeenObject& o) { return o.judged.log_odds; },
          "that it moves, natural logarithm; None: not asked for (variant evidence alone)")
      .def_property_readonly(
          "track", [](const SeenObject& o) { return o.judged.track; },
          "of a person: the same number in every frame; -1: not followed")
      .def("__repr__", [](const SeenObject& o) {
        return fmt::format("<ydd_slam.SeenObject '{}', {}>", o.class_name,
                           to_string(o.judged.rule));
      });
}

void bind_track(py::module_& module) {
  py::class_<WorldTrack>(
      module, "Track", R"(A person or moving thing in the map's frame, as it is believed to be now.

World frame of the map, metres, seconds; vectors and matrices are copies of float64.)")
      .def_readonly("id", &WorldTrack::id, "the same in every frame of a run, and of no other")
      .def_readonly("class_name", &WorldTrack::class_name, "'thing': never detected as anything")
      .def_readonly("position_m", &WorldTrack::position_m, "(3,): the middle of it")
      .def_readonly("velocity_m_s", &WorldTrack::velocity_m_s, "(3,), of its middle")
      .def_readonly("extent_m", &WorldTrack::extent_m, "(3,): width, height, depth for the camera")
      .def_readonly("position_covariance_m2", &WorldTrack::position_covariance_m2,
                    "(3, 3), of position_m")
      .def_readonly("velocity_covariance_m2_s2", &WorldTrack::velocity_covariance_m2_s2,
                    "(3, 3), of velocity_m_s")
      .def_readonly("age_s", &WorldTrack::age_s, "since it was first seen")
      .def_readonly("unseen_s", &WorldTrack::unseen_s, "since it was seen last; 0: in this frame")
      .def_readonly("moves", &WorldTrack::moves, "as judged when seen last")
      .def_readonly("log_odds", &WorldTrack::log_odds, "that it moves; None: nothing was known")
      .def("__repr__", [](const WorldTrack& t) {
        return fmt::format("<ydd_slam.Track {} '{}' at ({:.2f}, {:.2f}, {:.2f}) m>", t.id,
                           t.class_name, t.position_m.x(), t.position_m.y(), t.position_m.z());
      });
}

py::list objects_of(const RobotFrame& frame) {
  py::list out;
  for (const ObjectJudgement& object : frame.report.judgement.objects) {
    const bool known = object.detection >= 0;
    out.append(SeenObject{
        object, known
                    ? frame.report.detections[static_cast<std::size_t>(object.detection)].class_name
                    : ""});
  }
  return out;
}

py::dict times_of(const RobotFrame& frame) {
  py::dict out;
  for (const StageTime& time : frame.report.times) out[py::str(time.stage)] = time.wall_ms;
  return out;
}

void bind_pose(py::class_<RobotFrame, std::shared_ptr<RobotFrame>>& frame) {
  frame
      .def_readonly("has_pose", &RobotFrame::has_pose,
                    "whether it is known where the camera was: T_world_camera is there")
      .def_property_readonly(
          "T_world_camera",
          [](const RobotFrame& f) -> py::object {
            return f.has_pose ? py::object(matrix_of(f.T_map_camera)) : py::none();
          },
          "(4, 4) float64: camera frame (x right, y down, z forward) to world, metres; a copy. "
          "As it is believed now: Slam.trajectory() has what later frames correct. None without a "
          "pose")
      .def_property_readonly(
          "T_odom_camera", [](const RobotFrame& f) { return matrix_of(f.T_odom_camera); },
          "(4, 4): the same without jumps where the map is corrected; drifts")
      .def_readonly(
          "covariance", &RobotFrame::covariance,
          "(6, 6): of T_world_camera, position then rotation about the world's axes, square "
          "metres and radians; what the matches of this frame leave open")
      .def_readonly("velocity", &RobotFrame::velocity,
                    "(6,): m/s, then rad/s, in the camera frame");
}

}  // namespace

void bind_frame(py::module_& module) {
  bind_kept(module);
  bind_rejected(module);
  bind_seen_object(module);
  bind_track(module);
  py::list rules;
  for (int i = 0; i < kRuleCount; ++i) rules.append(to_string(static_cast<Rule>(i)));
  module.attr("RULES") = py::tuple(rules);
  py::class_<RobotFrame, std::shared_ptr<RobotFrame>> frame(
      module, "Frame", "What became of one picture. Made by Slam.process().");
  bind_pose(frame);
  frame
      .def_property_readonly(
          "index", [](const RobotFrame& f) { return f.report.index; },
          "which picture of the run, from 0; one of a recording keeps its own")
      .def_property_readonly(
          "stamp", [](const RobotFrame& f) { return f.report.stamp.seconds(); }, "seconds")
      .def_property_readonly(
          "stamp_ns", [](const RobotFrame& f) { return f.report.stamp.ns; }, "nanoseconds, exact")
      .def_property_readonly(
          "state", [](const RobotFrame& f) { return to_string(f.report.track.state); },
          "'initializing', 'tracking', 'coasting' or 'lost'")
      .def_property_readonly(
          "doubt", [](const RobotFrame& f) { return f.report.track.doubt; },
          "why it coasts, as words; '' when it does not")
      .def_property_readonly(
          "keyframe", [](const RobotFrame& f) { return f.report.keyframe; },
          "whether the map keeps it")
      .def_property_readonly(
          "inliers", [](const RobotFrame& f) { return f.report.track.inliers; },
          "map points that agree with the pose")
      .def_property_readonly(
          "kept",
          [](const SharedFrame& f) {
            return KeptPoints{f->report.filtered->kept, {f, &f->report.points}};
          },
          "KeptPoints: judged static, and all that tracking and the map see of it")
      .def_property_readonly(
          "rejected", [](SharedFrame f) { return RejectedPoints{std::move(f)}; },
          "RejectedPoints: judged to lie on something that moves, each with its rule")
      .def_property_readonly(
          "detections", [](const RobotFrame& f) { return f.report.detections; },
          "list of Detection: the boxes that were used")
      .def_property_readonly("objects", &objects_of,
                             "list of SeenObject: the detections that may move")
      .def_readonly("tracks", &RobotFrame::tracks, "list of Track: people and moving things")
      .def_property_readonly("times_ms", &times_of, "dict: wall time by stage; 'total' is all")
      .def("__repr__", [](const RobotFrame& f) {
        return fmt::format("<ydd_slam.Frame {} {}, {} points kept, {} rejected>", f.report.index,
                           to_string(f.report.track.state), f.report.filtered->kept->size(),
                           f.report.filtered->rejected.size());
      });
}

}  // namespace ydd::python
