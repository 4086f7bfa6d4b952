// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ydd/geometry/se3.h"
#include "ydd/simulation/mesh.h"
#include "ydd/simulation/texture.h"

/// The world as data: who is there, what it looks like, how it moves. The world frame has z up, the
/// floor at z = 0, metres.
namespace ydd::sim {

/// A thing with a name. Parts of people (head, hands) are objects of their own inside the person.
struct SceneObject {
  std::string class_name;
  std::string name;
  int id = 0;           ///< as in masks and lists; movers 1 to 255, head and hands as their person
  int whole = -1;       ///< index of the object that this is a part of
  bool moving = false;  ///< moves at some time
};

/// A mesh with its texture. `uv` of the mesh is in [0, 1] or metres; `texels_per_uv` makes texels.
struct Part {
  Mesh mesh;
  int texture = 0;
  Eigen::Vector2f texels_per_uv = Eigen::Vector2f::Ones();
  int object = -1;  ///< index into Scene::objects, -1: walls and other things without a name
  float glow = 0;   ///< > 0: shines by itself (screens, lamps, windows), whatever the light
};

/// Rigid parts and where their common frame is.
struct Body {
  std::vector<Part> parts;
};

/// One or several bodies that move together in a way of their own (a person's limbs).
struct Actor {
  std::vector<Body> bodies;
  /// T_world_body of each body at a time in seconds since the start. Pure.
  std::function<std::vector<SE3>(double time_s)> poses;
};

/// A ceiling lamp that shines downwards.
struct Lamp {
  Vector3 centre;
  Vector3 half_size;
  float power = 1.0F;
};

/// Everything that can be seen.
struct Scene {
  std::vector<Texture> textures;
  std::vector<SceneObject> objects;
  std::vector<Part> fixed;  ///< in the world frame
  std::vector<Actor> actors;
  std::vector<Lamp> lamps;
  float ambient = 0.55F;
};

}  // namespace ydd::sim
