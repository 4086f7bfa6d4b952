// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <imgui.h>

namespace ydd {

/// One line or area of a chart.
struct ChartSeries {
  std::string name;
  std::vector<float> values;  ///< one per frame, oldest first
  ImU32 colour = 0;
  bool filled = false;  ///< an area on top of the filled ones before it
};

/// A small chart with a title above it, a scale from 0 and the newest values in its legend. `level`
/// is drawn across as a thin line (0: none). Takes `size` at the cursor.
void draw_chart(const char* title, std::span<const ChartSeries> series, float level,
                const char* unit, ImVec2 size);

/// A row: name, a bar of that share of the width, text at the right.
void draw_bar(const char* name, float share, ImU32 colour, const std::string& text, float width);

}  // namespace ydd
