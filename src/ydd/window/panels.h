// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/viewer/window_layout.h"
#include "ydd/window/gl_draw.h"
#include "ydd/window/map_view.h"
#include "ydd/window/view_state.h"

/// The parts of the window, one function each. Called between ImGui's NewFrame and Render.
namespace ydd {

/// What the mouse did over the map, in pixels since the last pass.
struct MapGesture {
  float orbit_x = 0, orbit_y = 0;
  float pan_x = 0, pan_y = 0;
  float zoom_steps = 0;
  bool any() const {
    return orbit_x != 0 || orbit_y != 0 || pan_x != 0 || pan_y != 0 || zoom_steps != 0;
  }
};

void draw_toolbar(const PixelRect& where, const PanelFacts& facts, ViewState& state,
                  PanelRequests& requests);
void draw_picture(const PixelRect& where, const gl::Texture& picture);
void draw_charts(const PixelRect& where, const PanelFacts& facts);
/// What lies over the map: state at the left, layers (its legend) at the right.
MapGesture draw_map_overlay(const PixelRect& where, const PanelFacts& facts, ViewState& state,
                            bool has_loops);
/// Names in the map, under everything that lies over it.
void draw_labels(const PixelRect& where, const std::vector<MapView::PlacedLabel>& labels);
/// Does what a key stands for (docs/live-view.md lists them), unless a question is open.
void take_key(char key, const PanelFacts& facts, ViewState& state, PanelRequests& requests);

}  // namespace ydd
