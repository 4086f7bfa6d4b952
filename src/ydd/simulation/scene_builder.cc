// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/scene_builder.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "ydd/simulation/surfaces.h"

namespace ydd::sim {
namespace {

constexpr int kMaterialSide = 512;
constexpr int kMaxMovers = 255;     // a mask is eight bits
constexpr int kFirstFixedId = 256;  // never in a mask

}  // namespace

SceneBuilder::SceneBuilder(Random random, double detail)
    : random_(random), texel_m_(static_cast<float>(0.003 / detail)) {
  const auto wood = [&](const Colour& colour) {
    return add_texture(paint_wood(next_random(), kMaterialSide, colour), Wrap::repeat);
  };
  const auto plain = [&](const Colour& colour, float grain) {
    return add_texture(paint_plain(next_random(), kMaterialSide, colour, grain), Wrap::repeat);
  };
  palette_.pale_wood = wood(bgr(0.45F, 0.62F, 0.76F));
  palette_.dark_wood = wood(bgr(0.14F, 0.23F, 0.36F));
  palette_.white = plain(grey(0.82F), 0.03F);
  palette_.black = plain(grey(0.11F), 0.03F);
  palette_.steel = plain(grey(0.5F), 0.06F);
  palette_.leather = plain(hsv(random_.uniform_f(0.0F, 1.0F), 0.5F, 0.4F), 0.2F);
  palette_.leaf = plain(bgr(0.12F, 0.42F, 0.18F), 0.25F);
}

int SceneBuilder::fine_texels(double metres) const {
  return std::max(4, static_cast<int>(metres / (0.6 * static_cast<double>(texel_m_))));
}

int SceneBuilder::add_texture(const Canvas& canvas, Wrap wrap) {
  scene_.textures.emplace_back(canvas, wrap);
  return static_cast<int>(scene_.textures.size()) - 1;
}

int SceneBuilder::add_object(const std::string& class_name) {
  SceneObject object;
  object.class_name = class_name;
  object.name = fmt::format("{}{}", class_name, fixed_objects_);
  object.id = kFirstFixedId + fixed_objects_++;
  scene_.objects.push_back(object);
  return static_cast<int>(scene_.objects.size()) - 1;
}

int SceneBuilder::add_mover(const std::string& class_name, const std::string& name) {
  if (movers_ == kMaxMovers) throw std::logic_error("SceneBuilder: more than 255 movers");
  SceneObject object;
  object.class_name = class_name;
  object.name = name;
  object.id = ++movers_;
  object.moving = true;
  scene_.objects.push_back(object);
  return static_cast<int>(scene_.objects.size()) - 1;
}

int SceneBuilder::add_limb(int whole, const std::string& class_name, const std::string& name) {
  SceneObject object = scene_.objects.at(whole);
  object.class_name = class_name;
  object.name = name;
  object.whole = whole;
  scene_.objects.push_back(object);
  return static_cast<int>(scene_.objects.size()) - 1;
}

Part SceneBuilder::cut(Mesh mesh, int material, int object) {
  const float v = random_.uniform_f(0.0F, 3.0F);
  const float u = random_.uniform_f(0.0F, 3.0F);
  return {with_uv(std::move(mesh), Eigen::Vector2f::Ones(), {u, v}), material,
          Eigen::Vector2f::Constant(1.0F / texel_m_), object};
}

Part SceneBuilder::covered(Mesh mesh, int picture, int object) const {
  const Texture& texture = scene_.textures.at(picture);
  const Eigen::Vector2f size(static_cast<float>(texture.width()),
                             static_cast<float>(texture.height()));
  return {std::move(mesh), picture, size, object};
}

void SceneBuilder::place(const std::vector<Part>& parts, const SE3& T_world_parts) {
  for (const Part& part : parts) {
    Part placed = part;
    placed.mesh = transformed(part.mesh, T_world_parts);
    scene_.fixed.push_back(std::move(placed));
  }
}

void SceneBuilder::freeze(double time_s) {
  for (Actor& actor : scene_.actors) {
    actor.poses = [poses = actor.poses(time_s)](double) { return poses; };
  }
  for (SceneObject& object : scene_.objects) object.moving = false;
}

}  // namespace ydd::sim
