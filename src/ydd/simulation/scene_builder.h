// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ydd/simulation/scene.h"

namespace ydd::sim {

/// Materials that many things are made of: indices of repeating textures.
struct Palette {
  int pale_wood = 0;
  int dark_wood = 0;
  int white = 0;
  int black = 0;
  int steel = 0;
  int leather = 0;
  int leaf = 0;
};

/// Collects textures, objects and parts into a scene.
class SceneBuilder {
 public:
  /// `detail` scales the texture resolution: 1 suits 640 x 480 from a metre away.
  SceneBuilder(Random random, double detail);

  const Palette& palette() const { return palette_; }
  /// Texel size of materials and walls.
  float texel_m() const { return texel_m_; }
  /// Texels for `metres` of a picture that is looked at closely.
  int fine_texels(double metres) const;
  /// A generator of its own for the next thing.
  Random next_random() { return random_.fork(random_.bits()); }
  /// What follows depends on `random` alone: things built after equal calls look alike.
  void reseed(const Random& random) { random_ = random; }

  int add_texture(const Canvas& canvas, Wrap wrap = Wrap::clamp);
  /// A thing that stays where it is; returns the index of the object.
  int add_object(const std::string& class_name);
  /// A thing that moves at some time. @throws std::logic_error beyond 255 of them.
  int add_mover(const std::string& class_name, const std::string& name);
  /// Part of a mover (head, hand): shares its id.
  int add_limb(int whole, const std::string& class_name, const std::string& name);

  /// A part made of a material, cut from anywhere on it.
  Part cut(Mesh mesh, int material, int object);
  /// A part whose uv in [0, 1] cover all of a picture.
  Part covered(Mesh mesh, int picture, int object) const;

  void place(const std::vector<Part>& parts, const SE3& T_world_parts);
  void add_actor(Actor actor) { scene_.actors.push_back(std::move(actor)); }
  void add_lamp(const Lamp& lamp) { scene_.lamps.push_back(lamp); }
  void add_window(const Lamp& window) { scene_.windows.push_back(window); }
  void add_desk_lamp(const Lamp& lamp) { scene_.desk_lamps.push_back(lamp); }
  void set_light(std::optional<LightChanges> light) { scene_.light = std::move(light); }

  /// Turns all actors so far into statues: they stand as at `time_s`, no object moves any more.
  void freeze(double time_s);

  Scene finish() && { return std::move(scene_); }

 private:
  Random random_;
  float texel_m_;
  Scene scene_;
  Palette palette_;
  int movers_ = 0;
  int fixed_objects_ = 0;
};

}  // namespace ydd::sim
