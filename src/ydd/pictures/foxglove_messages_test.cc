// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/foxglove_messages.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ydd::foxglove {
namespace {

using nlohmann::json;

TEST(Foxglove, Base64IsThatOfTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Foxglove, TheMapHasItsZUp) {
  const Eigen::Vector3d up_world(0, -1, 0), ahead_world(0, 0, 1);
  EXPECT_TRUE((world_in_map() * up_world).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE((world_in_map() * ahead_world).isApprox(Eigen::Vector3d::UnitX()));
}

/// Every key of `value` is in the schema, with its type; so Foxglove does not miss one.
void expect_fits(const json& value, const json& schema, const std::string& where) {
  const std::string type = schema.value("type", "");
  if (value.is_object()) {
    EXPECT_EQ(type, "object") << where;
    for (const auto& [key, inner] : value.items()) {
      ASSERT_TRUE(schema.at("properties").contains(key)) << where << "." << key;
      expect_fits(inner, schema["properties"][key], where + "." + key);
    }
  } else if (value.is_array()) {
    EXPECT_EQ(type, "array") << where;
    for (const json& inner : value) expect_fits(inner, schema.at("items"), where + "[]");
  } else {
    EXPECT_EQ(type, value.is_string()           ? "string"
                    : value.is_boolean()        ? "boolean"
                    : value.is_number_integer() ? (type == "number" ? "number" : "integer")
                                                : "number")
        << where;
  }
}

WorldTrack somebody() {
  WorldTrack track;
  track.id = 7;
  track.class_name = "person";
  track.position_m = {1, 2, 3};
  track.extent_m = {0.5, 1.8, 0.4};
  track.velocity_m_s = {0, 0, 0.8};
  track.moves = true;
  return track;
}

TEST(Foxglove, MessagesAreAsTheirSchemasSay) {
  const Timestamp stamp{1'700'000'000'250'000'000};
  const SE3 T(Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {1, 2, 3});
  const Atlas empty(Camera(), PyramidScales::make(8, 1.2));
  const std::vector<std::pair<std::string, std::string>> messages = {
      {"foxglove.PoseInFrame", pose_in_frame(stamp, T)},
      {"foxglove.FrameTransform", frame_transform(stamp, "map", "world", T)},
      {"foxglove.CompressedImage", compressed_image(stamp, "jpeg")},
      {"foxglove.PointCloud", point_cloud(stamp, empty, {}, 10)},
      {"foxglove.SceneUpdate", scene_update(stamp, {somebody()})}};
  for (const auto& [name, message] : messages) {
    expect_fits(json::parse(message), json::parse(schema_of(name)), name);
  }
  EXPECT_TRUE(schema_of("foxglove.Grid").empty());
  const json pose = json::parse(messages[0].second);
  EXPECT_EQ(pose["timestamp"], json({{"sec", 1'700'000'000}, {"nsec", 250'000'000}}));
  EXPECT_EQ(pose["pose"]["orientation"]["w"], 0.5);
  EXPECT_EQ(pose["pose"]["position"]["z"], 3.0);
}

TEST(Foxglove, ATrackIsABoxWithANameAndItsWay) {
  const json scene = json::parse(scene_update({5}, {somebody()}));
  const json& entity = scene["entities"][0];
  EXPECT_EQ(entity["id"], "7");
  EXPECT_EQ(entity["texts"][0]["text"], "person 7");
  EXPECT_EQ(entity["cubes"][0]["size"]["y"], 1.8);
  EXPECT_EQ(entity["arrows"][0]["shaft_length"], 0.8);
  // The arrow points along x before it is turned: its way is along z.
  const json& turn = entity["arrows"][0]["pose"]["orientation"];
  const Eigen::Quaterniond q(turn["w"], turn["x"], turn["y"], turn["z"]);
  EXPECT_TRUE((q * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ()));
  WorldTrack still = somebody();
  still.velocity_m_s.setZero();
  EXPECT_TRUE(json::parse(scene_update({5}, {still}))["entities"][0]["arrows"].empty());
}

}  // namespace
}  // namespace ydd::foxglove
