// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/simulation/scene_builder.h"

/// Furniture as parts in a frame of its own: x to the right, the front towards -y, z up, the origin
/// on the floor (or on what it stands on) below the middle, for furniture that stands at a wall
/// below the middle of its back.
namespace ydd::sim {

using Parts = std::vector<Part>;

Parts make_desk(SceneBuilder& builder, float width_m, float depth_m);
/// Swivel chair on five legs; the seat 0.46 m high, the back 0.95 m.
Parts make_chair(SceneBuilder& builder, int object);
Parts make_monitor(SceneBuilder& builder, int object, float width_m);
Parts make_keyboard(SceneBuilder& builder, int object);
Parts make_mouse(SceneBuilder& builder, int object);
/// A mug with handle, 0.1 m high.
Parts make_mug(SceneBuilder& builder, int object);
/// A book that lies on its back.
Parts make_flat_book(SceneBuilder& builder, int object, float width_m, float height_m);
/// Books side by side on a board of `width_m`; each an object.
Parts make_book_row(SceneBuilder& builder, float width_m, float max_height_m, bool objects);
/// Open shelf full of books and boxes.
Parts make_bookcase(SceneBuilder& builder, float width_m, float height_m);
Parts make_cabinet(SceneBuilder& builder, float width_m, float height_m);
Parts make_plant(SceneBuilder& builder, float height_m);
/// A picture that hangs: its middle at the origin, facing -y.
Parts make_hanging(SceneBuilder& builder, const Canvas& picture, float width_m, float height_m,
                   int object = -1);

/// Table fan. `foot` is fixed, `head` (cage and motor) turns about z at 0.33 m, `rotor` about the
/// head's y axis.
struct Fan {
  Parts foot;
  Parts head;
  Parts rotor;
};
Fan make_fan(SceneBuilder& builder, int object);
inline constexpr float kFanAxisHeight_m = 0.33F;

}  // namespace ydd::sim
