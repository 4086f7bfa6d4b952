// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
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

/// Where light comes from. `itself`: things that shine whatever the light, as screens do.
enum class LightSource { itself, sky, ceiling, window, sun, desk };
inline constexpr std::size_t kLightSources = 6;

/// A factor for each source, BGR.
using SourceLight = std::array<Eigen::Array3f, kLightSources>;

/// A mesh with its texture. `uv` of the mesh is in [0, 1] or metres; `texels_per_uv` makes texels.
struct Part {
  Mesh mesh;
  int texture = 0;
  Eigen::Vector2f texels_per_uv = Eigen::Vector2f::Ones();
  int object = -1;  ///< index into Scene::objects, -1: walls and other things without a name
  float glow = 0;   ///< > 0: shines by itself (screens, lamps, windows), whatever the light
  LightSource source = LightSource::itself;  ///< what its glow goes with when light changes
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

/// A lamp, a rectangle that shines to one side: a ceiling lamp downwards, a window into the room.
struct Lamp {
  Vector3 centre;
  Vector3 half_size;
  float power = 1.0F;
  Vector3 facing = -Vector3::UnitZ();  ///< unit; zero: to all sides
};

/// What each source of light gives at a moment.
struct LightNow {
  SourceLight sources;
  double exposure = 1.0;  ///< what the automatic of the camera gets wrong, a factor
};

/// Light that is not the same at all times.
struct LightChanges {
  Vector3 to_sun = Vector3::UnitZ();          ///< unit, world frame
  std::function<LightNow(double time_s)> at;  ///< pure
};

/// Everything that can be seen.
struct Scene {
  std::vector<Texture> textures;
  std::vector<SceneObject> objects;
  std::vector<Part> fixed;  ///< in the world frame
  std::vector<Actor> actors;
  std::vector<Lamp> lamps;
  float ambient = 0.55F;
  std::vector<Lamp> windows, desk_lamps;  ///< they shine where light changes, and only there
  std::optional<LightChanges> light;      ///< nothing: `lamps` and `ambient` shine, in white
};

}  // namespace ydd::sim
