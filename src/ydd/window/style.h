// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include "ydd/image/image.h"
#include "ydd/viewer/map_scene.h"

namespace ydd {

/// Dark, flat, legible: colours and spacing of the panels.
void apply_style(float scale);
/// A real font where the system has one (DejaVu), else ImGui's own; `scale` 1 on ordinary screens.
void load_font(float scale);

inline ImU32 colour(Rgba c) { return IM_COL32(c[0], c[1], c[2], c[3]); }
inline ImU32 colour(Bgr c) { return IM_COL32(c[2], c[1], c[0], 255); }

inline constexpr ImU32 kQuiet = IM_COL32(150, 158, 172, 255);
inline constexpr ImU32 kText = IM_COL32(228, 232, 240, 255);

}  // namespace ydd
