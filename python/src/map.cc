// SPDX-License-Identifier: Apache-2.0
#include "map.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "frame.h"
#include "trajectory.h"
#include "ydd/base/files.h"
#include "ydd/cloud/keyframe_picture.h"
#include "ydd/cloud/occupancy_grid.h"
#include "ydd/cloud/ply.h"
#include "ydd/map_files/map_file.h"
#include "ydd/system/localise.h"

namespace ydd::python {
namespace {

/// Calls `visit(id, keyframe)` for those of one map, in the order of the arrays.
template <class Visit>
void for_keyframes(const Map& map, Visit&& visit) {
  map.atlas->keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.map == map.id) visit(id, keyframe);
  });
}

template <class Visit>
void for_points(const Map& map, Visit&& visit) {
  map.atlas->points().for_each([&](MapPointId id, const MapPoint& point) {
    if (map.atlas->map_of(point.observations.front().keyframe) == map.id) visit(id, point);
  });
}

/// A row of each keyframe or point.
template <class Value, class For, class Add>
py::array_t<Value> rows(const Map& map, For for_each, py::ssize_t width, Add add) {
  std::vector<Value> values;
  without_gil([&] { for_each(map, [&](auto id, const auto& entry) { add(values, id, entry); }); });
  return taken(std::move(values), width);
}
const auto kKeyframes = [](const Map& map, auto&& visit) { for_keyframes(map, visit); };
const auto kPoints = [](const Map& map, auto&& visit) { for_points(map, visit); };

void append(std::vector<double>& values, const Eigen::Vector3d& p) {
  values.insert(values.end(), p.data(), p.data() + 3);
}

py::array_t<double> keyframe_poses(const Map& map) {
  const auto flat = rows<double>(map, kKeyframes, 16, [](auto& values, auto, const KeyFrame& k) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> M = k.T_world_camera.matrix();
    values.insert(values.end(), M.data(), M.data() + 16);
  });
  return py::array_t<double>(flat).reshape({flat.shape(0), py::ssize_t{4}, py::ssize_t{4}});
}

/// Where each keyframe is in the arrays.
std::unordered_map<KeyFrameId, std::int64_t> places_of_keyframes(const Map& map) {
  std::unordered_map<KeyFrameId, std::int64_t> places;
  for_keyframes(map, [&](KeyFrameId id, const KeyFrame&) {
    places.emplace(id, static_cast<std::int64_t>(places.size()));
  });
  return places;
}

py::array_t<std::int64_t> covisibility(const Map& map) {
  const auto places = places_of_keyframes(map);
  return rows<std::int64_t>(map, kKeyframes, 3, [&](auto& out, KeyFrameId id, const KeyFrame& k) {
    for (const Covisible& other : k.covisible) {
      const auto found = places.find(other.keyframe);
      if (found == places.end() || found->second <= places.at(id)) continue;
      out.insert(out.end(), {places.at(id), found->second, other.weight});
    }
  });
}

py::array_t<std::int64_t> observations(const Map& map) {
  const auto places = places_of_keyframes(map);
  std::int64_t index = 0;
  return rows<std::int64_t>(map, kPoints, 3, [&](auto& out, auto, const MapPoint& point) {
    for (const Observation& seen : point.observations) {
      const auto found = places.find(seen.keyframe);
      if (found != places.end()) out.insert(out.end(), {found->second, index, seen.keypoint});
    }
    ++index;
  });
}

/// Positions and colours, views of one cloud.
py::tuple cloud_arrays(std::vector<CloudPoint> cloud) {
  const auto held = std::make_shared<const std::vector<CloudPoint>>(std::move(cloud));
  const py::capsule owner = keeper_of<std::vector<CloudPoint>>(held);
  const auto size = static_cast<py::ssize_t>(held->size());
  static const CloudPoint nothing{Eigen::Vector3f::Zero(), {}};
  const CloudPoint& first = held->empty() ? nothing : held->front();
  return py::make_tuple(
      view(first.p_world.data(), {size, 3}, {sizeof(CloudPoint), sizeof(float)}, owner),
      view(first.colour.data(), {size, 3}, {sizeof(CloudPoint), 1}, owner));
}

DenseCloudOptions cloud_options(double voxel_m, double max_depth_m) {
  if (!(voxel_m >= 0.001 && voxel_m <= 10)) throw Failure("voxel_m: must be in [0.001, 10]");
  if (!(max_depth_m >= 0.1 && max_depth_m <= 100))
    throw Failure("max_depth_m: must be in [0.1, 100]");
  DenseCloudOptions options;
  options.voxel_m = voxel_m;
  options.max_depth_m = max_depth_m;
  return options;
}

py::tuple dense_arrays(const Map& map, double voxel_m, double max_depth_m) {
  const DenseCloudOptions options = cloud_options(voxel_m, max_depth_m);
  return cloud_arrays(
      value_of(without_gil([&] { return dense_cloud(*map.atlas, map.id, options); })));
}

void write_ply(const Map& map, const std::filesystem::path& file, bool dense, double voxel_m,
               double max_depth_m) {
  const DenseCloudOptions options = cloud_options(voxel_m, max_depth_m);
  without_gil([&] {
    const std::string text = dense ? format_ply(value_of(dense_cloud(*map.atlas, map.id, options)))
                                   : format_sparse_ply(*map.atlas, map.id);
    value_of(write_file_atomically(file, text));
  });
}

py::dict grid_of_map(const Map& map, double resolution_m) {
  GridOptions options;
  options.resolution_m = resolution_m;
  OccupancyGrid grid = without_gil([&] {
    const FloorPlane floor = value_of(floor_of_map(*map.atlas, map.id, options.cloud));
    return value_of(occupancy_grid(*map.atlas, map.id, level_frame(floor), options));
  });
  std::vector<std::int8_t> cells;
  for (const Cell cell : grid.cells) cells.push_back(static_cast<std::int8_t>(cell));
  py::dict out;
  out["cells"] =
      taken(std::move(cells)).reshape({py::ssize_t{grid.rows}, py::ssize_t{grid.columns}});
  out["resolution_m"] = grid.resolution_m;
  out["origin_m"] = py::make_tuple(grid.origin_m.x(), grid.origin_m.y());
  out["T_grid_world"] = matrix_of(grid.T_grid_world);
  return out;
}

/// Of the arrays' order; lives as long as the map's atlas.
const KeyFrame& keyframe_at(const Map& map, std::int64_t index) {
  const KeyFrame* found = nullptr;
  std::int64_t at = 0;
  for_keyframes(map, [&](KeyFrameId, const KeyFrame& k) {
    if (at++ == index) found = &k;
  });
  if (!found) throw py::index_error("the map has " + std::to_string(at) + " keyframes");
  return *found;
}

KeptPoints features_of(const Map& map, std::int64_t index) {
  const KeyFrame& keyframe = keyframe_at(map, index);
  return {keyframe.shared_features, {map.atlas, &keyframe.points}};
}

py::object picture_of(const Map& map, std::int64_t index) {
  const std::shared_ptr<const KeyFramePicture> picture = keyframe_at(map, index).picture;
  if (!picture) return py::none();
  const OpenPicture opened = value_of(without_gil([&] { return open_keyframe_picture(*picture); }));
  const auto depth = std::make_shared<const RawDepthImage>(opened.depth_mm);
  return py::make_tuple(
      view_of(opened.colour),
      view(depth->data(), {depth->height(), depth->width()}, {}, keeper_of<RawDepthImage>(depth)));
}

py::object localise_in(const Map& map, const RgbdFrame& frame) {
  const Camera& camera = map.atlas->camera();
  if (frame.grey.width() != camera.width_px || frame.grey.height() != camera.height_px) {
    throw Failure(fmt::format("the picture is {} x {} px, the map's camera {} x {}",
                              frame.grey.width(), frame.grey.height(), camera.width_px,
                              camera.height_px));
  }
  SystemOptions options;
  options.orb.levels = map.atlas->scales().levels();
  if (options.orb.levels > 1) options.orb.scale_step = map.atlas->scales().factor[1];
  const auto found = without_gil([&] { return localise(*map.atlas, frame, options); });
  if (!found || found->map != map.id) return py::none();
  return matrix_of(found->T_world_camera);
}

std::vector<Map> maps_of(const std::shared_ptr<const Atlas>& atlas) {
  std::map<MapId, int> keyframes;
  atlas->keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { ++keyframes[k.map]; });
  std::vector<std::pair<int, Map>> found;
  for (const auto& [id, count] : keyframes) found.emplace_back(count, Map{atlas, id});
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Map> out;
  for (auto& [count, map] : found) out.push_back(std::move(map));
  return out;
}

Map load(const std::filesystem::path& file, const py::object& map_key) {
  const MapKey key = map_key_from(map_key);
  return largest_map(without_gil([&] { return value_of(load_map(file, key)).snapshot(); }));
}

using MapClass = py::class_<Map>;

void bind_points(MapClass& map) {
  map.def_property_readonly(
         "points",
         [](const Map& m) {
           return rows<double>(m, kPoints, 3, [](auto& values, auto, const MapPoint& p) {
             append(values, p.p_world);
           });
         },
         "(P, 3) float64: landmarks, world, metres")
      .def_property_readonly(
          "normals",
          [](const Map& m) {
            return rows<double>(m, kPoints, 3, [](auto& values, auto, const MapPoint& p) {
              append(values, p.normal);
            });
          },
          "(P, 3) float64: mean unit direction from the cameras to each landmark")
      .def_property_readonly(
          "point_ids",
          [](const Map& m) {
            return rows<std::int64_t>(m, kPoints, 1, [](auto& values, auto id, const MapPoint&) {
              values.push_back(number_of(id));
            });
          },
          "(P,) int64: as in KeptPoints.map_points")
      .def_property_readonly(
          "descriptors",
          [](const Map& m) {
            return rows<std::uint8_t>(
                m, kPoints, sizeof(Descriptor), [](auto& values, auto, const MapPoint& p) {
                  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&p.descriptor);
                  values.insert(values.end(), bytes, bytes + sizeof(Descriptor));
                });
          },
          "(P, 32) uint8: 256 bits (ORB)")
      .def_property_readonly(
          "observations", &observations,
          "(O, 3) int64: index of keyframe, of point, and of the keyframe's keypoint");
}

void bind_keyframes(MapClass& map) {
  map.def_property_readonly("keyframe_poses", &keyframe_poses, "(K, 4, 4) float64: T_world_camera")
      .def_property_readonly(
          "keyframe_stamps_ns",
          [](const Map& m) {
            return rows<std::int64_t>(m, kKeyframes, 1, [](auto& values, auto, const KeyFrame& k) {
              values.push_back(k.stamp.ns);
            });
          },
          "(K,) int64, nanoseconds")
      .def_property_readonly(
          "keyframe_frames",
          [](const Map& m) {
            return rows<std::int64_t>(m, kKeyframes, 1, [](auto& values, auto, const KeyFrame& k) {
              values.push_back(k.frame_index);
            });
          },
          "(K,) int64: Frame.index of each")
      .def_property_readonly(
          "covisibility", &covisibility,
          "(E, 3) int64: indices of two keyframes (the lesser first) and the number of landmarks "
          "that both saw when the later one was refreshed last; pairs with few are left out")
      .def(
          "keyframe_picture", &picture_of, py::arg("index"),
          "What keyframe `index` keeps of its picture: colour (h, w, 3) uint8 BGR and depth (h, w) "
          "uint16 in millimetres (0: none), half as wide and high, without what moves; None: "
          "nothing. Read-only, made at each call.")
      .def("keyframe_features", &features_of, py::arg("index"),
           "KeptPoints of keyframe `index`: what `observations` and `map_points` number. Shared.");
}

void bind_work(MapClass& map) {
  map.def("dense_cloud", &dense_arrays, py::arg("voxel_m") = 0.02, py::arg("max_depth_m") = 4.0,
          R"(The static scene as the keyframes' pictures show it: (points, colours).

points (N, 3) float32, world, metres; colours (N, 3) uint8, blue green red. Read-only views of one
cloud. Averaged in cubes of voxel_m; readings beyond max_depth_m are left out.)")
      .def("occupancy_grid", &grid_of_map, py::arg("resolution_m") = 0.05,
           R"(The floor from above: a dict of

cells         (rows, columns) int8: -1 unknown, 0 free, 100 occupied; rows by rising y
resolution_m  edge of a cell
origin_m      (x, y) of the lower corner of cells[0, 0] in the grid's frame
T_grid_world  (4, 4): the grid's frame (z up, floor at 0) from the map's world)")
      .def("write_ply", &write_ply, py::arg("file"), py::arg("dense") = true,
           py::arg("voxel_m") = 0.02, py::arg("max_depth_m") = 4.0,
           "Writes the dense cloud, or (dense=False) the landmarks, as binary PLY.")
      .def(
          "save",
          [](const Map& m, const std::filesystem::path& file, const py::object& map_key) {
            const MapKey key = map_key_from(map_key);
            value_of(without_gil([&] { return save_map(*m.atlas, file, Replacing::lesser, key); }));
          },
          py::arg("file"), py::kw_only(), py::arg("map_key") = py::none(),
          "Saves all maps of the run to one file (docs/maps.md), whole or not at all. A map that "
          "holds more is kept as FILE.previous. map_key as for load().")
      .def("localise", &localise_in, py::arg("frame"),
           R"(Where one picture (RgbdFrame) was taken, by what it shows alone.

(4, 4) float64 T_world_camera, or None when its place is not recognised. The map stays as it is. For
a sequence, Slam(camera, map=..., localization_only=True) knows where the camera was before.)");
}

}  // namespace

MapKey map_key_from(const py::object& given) {
  if (!py::isinstance<py::bytes>(given)) {
    return value_of(MapKey::find(given.is_none() ? "" : given.cast<std::filesystem::path>()));
  }
  Result<MapKey> key = MapKey::of(std::string_view(py::reinterpret_borrow<py::bytes>(given)));
  if (!key) throw Failure("map_key: " + key.error().message);
  return *std::move(key);
}

Map largest_map(std::shared_ptr<const Atlas> atlas) {
  std::vector<Map> maps = maps_of(atlas);
  return maps.empty() ? Map{std::move(atlas), {}} : std::move(maps.front());
}

std::optional<Atlas> atlas_of(const Map& map) {
  if (map.atlas->keyframes().empty()) return std::nullopt;
  return map.atlas->fork();
}

void bind_map(py::module_& module) {
  MapClass map(
      module, "Map",
      R"(A map as it was when it was asked for: what Slam does afterwards does not change it.

Arrays of points, keyframes and what connects them are made at each access (keep them), in an order
that is the same for all of one Map. World frame: the camera of the map's first keyframe (x right,
y down, z forward), metres.)");
  map.def_static("load", &load, py::arg("file"), py::kw_only(), py::arg("map_key") = py::none(),
                 R"(The largest map of a file that `ydd-slam run --save-map` or save() wrote.

map_key: of an encrypted file (docs/privacy.md), the name of the file with its key, or as bytes the
key itself; None: the file that the environment's YDD_MAP_KEY_FILE names, else it is plain)")
      .def_property_readonly(
          "camera", [](const Map& m) { return m.atlas->camera(); },
          "the Camera that it was made with, a copy")
      .def_property_readonly(
          "maps", [](const Map& m) { return maps_of(m.atlas); },
          "list of Map: all of the run, the largest first; a new one begins where the camera was "
          "lost, and goes when both see the same place")
      .def("__repr__", [](const Map& m) {
        std::size_t keyframes = 0, points = 0;
        for_keyframes(m, [&](KeyFrameId, const KeyFrame&) { ++keyframes; });
        for_points(m, [&](MapPointId, const MapPoint&) { ++points; });
        return fmt::format("<ydd_slam.Map of {} keyframes, {} points>", keyframes, points);
      });
  bind_points(map);
  bind_keyframes(map);
  bind_work(map);
}

}  // namespace ydd::python
