// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/foxglove_messages.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ydd/base/byte_writer.h"
#include "ydd/base/json_text.h"

namespace ydd::foxglove {
namespace {

using FoxJson = nlohmann::ordered_json;

constexpr int kFloat32 = 7;  // of foxglove.NumericType
constexpr const char* kWorld = "world";
constexpr const char* kCamera = "camera";

FoxJson time_json(Timestamp stamp) {
  return {{"sec", stamp.ns / 1'000'000'000}, {"nsec", stamp.ns % 1'000'000'000}};
}

FoxJson vector_json(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

FoxJson turn_json(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

FoxJson pose_json(const SE3& T) {
  return {{"position", vector_json(T.translation())}, {"orientation", turn_json(T.rotation())}};
}

FoxJson colour_json(bool moves, double alpha) {
  return {{"r", moves ? 0.9 : 0.3}, {"g", moves ? 0.3 : 0.6}, {"b", 0.8}, {"a", alpha}};
}

/// An arrow along `way_m`, which points along x where it is not turned.
FoxJson arrow_json(const WorldTrack& track) {
  const Eigen::Vector3d& way_m = track.velocity_m_s;  // of the next second
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), way_m);
  return {{"pose", pose_json(SE3(turn, track.position_m))},
          {"shaft_length", way_m.norm()},
          {"shaft_diameter", 0.04},
          {"head_length", 0.1},
          {"head_diameter", 0.1},
          {"color", colour_json(true, 1)}};
}

FoxJson entity_json(Timestamp stamp, const WorldTrack& track) {
  constexpr double kLeastWay_m = 0.05;
  const SE3 middle(Eigen::Quaterniond::Identity(), track.position_m);
  const Eigen::Vector3d above = track.position_m - Eigen::Vector3d(0, track.extent_m.y() / 2, 0);
  const FoxJson cube = {{"pose", pose_json(middle)},
                        {"size", vector_json(track.extent_m)},
                        {"color", colour_json(track.moves, 0.4)}};
  const FoxJson text = {{"pose", pose_json(SE3(Eigen::Quaterniond::Identity(), above))},
                        {"billboard", true},
                        {"font_size", 0.15},
                        {"scale_invariant", false},
                        {"color", colour_json(track.moves, 1)},
                        {"text", fmt::format("{} {}", track.class_name, track.id)}};
  FoxJson arrows = FoxJson::array();
  if (track.velocity_m_s.norm() > kLeastWay_m) arrows.push_back(arrow_json(track));
  FoxJson out = {{"timestamp", time_json(stamp)},
                 {"frame_id", kWorld},
                 {"id", fmt::format("{}", track.id)},
                 {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                 {"frame_locked", false},
                 {"metadata", FoxJson::array()},
                 {"arrows", std::move(arrows)},
                 {"cubes", FoxJson::array({cube})},
                 {"texts", FoxJson::array({text})}};
  for (const char* const none : {"spheres", "cylinders", "lines", "triangles", "models"}) {
    out[none] = FoxJson::array();
  }
  return out;
}

// --- schemas ------------------------------------------------------------------------------------

FoxJson object_schema(FoxJson properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}};
}
FoxJson list_schema(FoxJson items) { return {{"type", "array"}, {"items", std::move(items)}}; }

/// By name, as text.
std::map<std::string, std::string, std::less<>> make_schemas() {
  const FoxJson number = {{"type", "number"}}, whole = {{"type", "integer"}};
  const FoxJson text = {{"type", "string"}}, flag = {{"type", "boolean"}};
  const FoxJson bytes = {{"type", "string"}, {"contentEncoding", "base64"}};
  const FoxJson time = object_schema({{"sec", whole}, {"nsec", whole}});
  const FoxJson vector = object_schema({{"x", number}, {"y", number}, {"z", number}});
  const FoxJson turn = object_schema({{"x", number}, {"y", number}, {"z", number}, {"w", number}});
  const FoxJson colour =
      object_schema({{"r", number}, {"g", number}, {"b", number}, {"a", number}});
  const FoxJson pose = object_schema({{"position", vector}, {"orientation", turn}});
  const FoxJson field = object_schema({{"name", text}, {"offset", whole}, {"type", whole}});
  const FoxJson arrow = object_schema({{"pose", pose},
                                       {"shaft_length", number},
                                       {"shaft_diameter", number},
                                       {"head_length", number},
                                       {"head_diameter", number},
                                       {"color", colour}});
  const FoxJson cube = object_schema({{"pose", pose}, {"size", vector}, {"color", colour}});
  const FoxJson label = object_schema({{"pose", pose},
                                       {"billboard", flag},
                                       {"font_size", number},
                                       {"scale_invariant", flag},
                                       {"color", colour},
                                       {"text", text}});
  const FoxJson any = list_schema(object_schema(FoxJson::object()));
  const FoxJson entity = object_schema({{"timestamp", time},
                                        {"frame_id", text},
                                        {"id", text},
                                        {"lifetime", time},
                                        {"frame_locked", flag},
                                        {"metadata", any},
                                        {"arrows", list_schema(arrow)},
                                        {"cubes", list_schema(cube)},
                                        {"spheres", any},
                                        {"cylinders", any},
                                        {"lines", any},
                                        {"triangles", any},
                                        {"texts", list_schema(label)},
                                        {"models", any}});
  const auto with = [&](FoxJson more) {
    FoxJson out = {{"timestamp", time}, {"frame_id", text}};
    out.update(more);
    return json_text(object_schema(std::move(out)));
  };
  const FoxJson deletion = object_schema({{"timestamp", time}, {"type", whole}, {"id", text}});
  return {{"foxglove.PoseInFrame", with({{"pose", pose}})},
          {"foxglove.CompressedImage", with({{"data", bytes}, {"format", text}})},
          {"foxglove.PointCloud", with({{"pose", pose},
                                        {"point_stride", whole},
                                        {"fields", list_schema(field)},
                                        {"data", bytes}})},
          {"foxglove.FrameTransform", json_text(object_schema({{"timestamp", time},
                                                               {"parent_frame_id", text},
                                                               {"child_frame_id", text},
                                                               {"translation", vector},
                                                               {"rotation", turn}}))},
          {"foxglove.SceneUpdate", json_text(object_schema({{"deletions", list_schema(deletion)},
                                                            {"entities", list_schema(entity)}}))}};
}

}  // namespace

std::string_view schema_of(std::string_view name) {
  static const auto schemas = make_schemas();
  const auto found = schemas.find(name);
  return found == schemas.end() ? std::string_view() : found->second;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += k <= count ? kLetters[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return out;
}

SE3 world_in_map() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return SE3(R, Eigen::Vector3d::Zero());
}

std::string pose_in_frame(Timestamp stamp, const SE3& T_world_camera) {
  return json_text(FoxJson{
      {"timestamp", time_json(stamp)}, {"frame_id", kWorld}, {"pose", pose_json(T_world_camera)}});
}

std::string frame_transform(Timestamp stamp, std::string_view parent, std::string_view child,
                            const SE3& T_parent_child) {
  return json_text(FoxJson{{"timestamp", time_json(stamp)},
                           {"parent_frame_id", std::string(parent)},
                           {"child_frame_id", std::string(child)},
                           {"translation", vector_json(T_parent_child.translation())},
                           {"rotation", turn_json(T_parent_child.rotation())}});
}

std::string compressed_image(Timestamp stamp, std::string_view jpeg) {
  return json_text(FoxJson{{"timestamp", time_json(stamp)},
                           {"frame_id", kCamera},
                           {"data", base64(jpeg)},
                           {"format", "jpeg"}});
}

std::string point_cloud(Timestamp stamp, const Atlas& atlas, MapId map, std::size_t most) {
  const std::size_t step = atlas.points().size() / most + 1;
  std::size_t count = 0;
  ByteWriter bytes;
  atlas.points().for_each([&](MapPointId, const MapPoint& point) {
    if (count++ % step != 0 || point.observations.empty()) return;
    if (atlas.map_of(point.observations.front().keyframe) != map) return;
    for (int k = 0; k < 3; ++k) bytes.f32(static_cast<float>(point.p_world[k]));
  });
  FoxJson fields = FoxJson::array();
  for (int k = 0; k < 3; ++k) {
    fields.push_back({{"name", std::string(1, "xyz"[k])}, {"offset", 4 * k}, {"type", kFloat32}});
  }
  return json_text(FoxJson{{"timestamp", time_json(stamp)},
                           {"frame_id", kWorld},
                           {"pose", pose_json(SE3())},
                           {"point_stride", 12},
                           {"fields", std::move(fields)},
                           {"data", base64(std::move(bytes).take())}});
}

std::string scene_update(Timestamp stamp, const std::vector<WorldTrack>& tracks) {
  constexpr int kAll = 1;  // of foxglove.SceneEntityDeletionType
  const FoxJson gone = {{"timestamp", time_json(stamp)}, {"type", kAll}, {"id", ""}};
  FoxJson entities = FoxJson::array();
  for (const WorldTrack& track : tracks) entities.push_back(entity_json(stamp, track));
  return json_text(
      FoxJson{{"deletions", FoxJson::array({gone})}, {"entities", std::move(entities)}});
}

}  // namespace ydd::foxglove
