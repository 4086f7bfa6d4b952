// SPDX-License-Identifier: Apache-2.0
#include "ydd/window/charts.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include <fmt/format.h>

#include "ydd/window/style.h"

namespace ydd {
namespace {

constexpr ImU32 kChartGround = IM_COL32(255, 255, 255, 9);
constexpr ImU32 kLevel = IM_COL32(255, 255, 255, 60);

/// Where the values of a series stand, `below` added to each.
struct Frame {
  ImVec2 origin;  ///< bottom left
  ImVec2 size;
  float top = 1;  ///< value at the upper border

  ImVec2 at(std::size_t i, std::size_t count, float value) const {
    const float share = count > 1 ? static_cast<float>(i) / static_cast<float>(count - 1) : 0.0F;
    return {origin.x + share * size.x, origin.y - std::clamp(value / top, 0.0F, 1.0F) * size.y};
  }
};

/// 1, 2 or 5 times a power of ten, at least `value`.
float round_up(float value) {
  const float power = std::pow(10.0F, std::floor(std::log10(std::max(value, 1e-3F))));
  for (const float step : {1.0F, 2.0F, 5.0F}) {
    if (value <= step * power) return step * power;
  }
  return 10 * power;
}

std::vector<float> stacked(std::span<const ChartSeries> series) {
  std::vector<float> sum;
  for (const ChartSeries& s : series) {
    if (!s.filled) continue;
    sum.resize(s.values.size());
    for (std::size_t i = 0; i < s.values.size(); ++i) sum[i] += s.values[i];
  }
  return sum;
}

/// A single slow frame must not flatten all others: the highest value but one in fifty.
float usual_top(std::span<const ChartSeries> series, float level) {
  float top = level;
  const auto take = [&](std::vector<float> values) {
    if (values.empty()) return;
    const auto n = static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + n, values.end());
    top = std::max(top, values[static_cast<std::size_t>(n)]);
  };
  take(stacked(series));
  for (const ChartSeries& s : series) {
    if (!s.filled) take(s.values);
  }
  return round_up(1.08F * top);
}

void fill_area(ImDrawList& canvas, const Frame& frame, const std::vector<float>& below,
               const ChartSeries& series) {
  const std::size_t n = series.values.size();
  const ImDrawListFlags flags = canvas.Flags;
  canvas.Flags &= ~ImDrawListFlags_AntiAliasedFill;  // soft edges would show as stripes
  for (std::size_t i = 1; i < n; ++i) {
    canvas.AddQuadFilled(
        frame.at(i - 1, n, below[i - 1]), frame.at(i - 1, n, below[i - 1] + series.values[i - 1]),
        frame.at(i, n, below[i] + series.values[i]), frame.at(i, n, below[i]), series.colour);
  }
  canvas.Flags = flags;
}

void draw_series(ImDrawList& canvas, const Frame& frame, std::span<const ChartSeries> series) {
  std::vector<float> below;
  for (const ChartSeries& s : series) {
    if (s.filled) {
      below.resize(s.values.size());
      fill_area(canvas, frame, below, s);
      for (std::size_t i = 0; i < s.values.size(); ++i) below[i] += s.values[i];
      continue;
    }
    std::vector<ImVec2> line;
    for (std::size_t i = 0; i < s.values.size(); ++i) {
      line.push_back(frame.at(i, s.values.size(), s.values[i]));
    }
    canvas.AddPolyline(line.data(), static_cast<int>(line.size()), s.colour, 0, 1.6F);
  }
}

/// Names and newest values, from the right; a series without a name is left out.
void draw_legend(ImDrawList& canvas, std::span<const ChartSeries> series, const char* unit,
                 ImVec2 top_right) {
  float x = top_right.x;
  for (const ChartSeries& s : series | std::views::reverse) {
    if (s.name.empty()) continue;
    const float newest = s.values.empty() ? 0 : s.values.back();
    const std::string text = fmt::format("{} {:.0f}{}", s.name, newest, unit);
    x -= ImGui::CalcTextSize(text.c_str()).x;
    canvas.AddText({x, top_right.y}, kText, text.c_str());
    x -= 12;
    const float middle = top_right.y + ImGui::GetFontSize() / 2;
    canvas.AddRectFilled({x, middle - 4}, {x + 8, middle + 4}, s.colour | IM_COL32_A_MASK, 2);
    x -= 10;
  }
}

}  // namespace

void draw_chart(const char* title, std::span<const ChartSeries> series, float level,
                const char* unit, ImVec2 size) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const float head = ImGui::GetTextLineHeightWithSpacing();
  canvas.AddText(corner, kQuiet, title);
  draw_legend(canvas, series, unit, {corner.x + size.x, corner.y});
  const Frame frame{
      {corner.x, corner.y + size.y}, {size.x, size.y - head}, usual_top(series, level)};
  const ImVec2 top_left(corner.x, corner.y + head);
  const ImVec2 bottom_right(corner.x + size.x, corner.y + size.y);
  canvas.AddRectFilled(top_left, bottom_right, kChartGround, 3);
  canvas.PushClipRect(top_left, bottom_right, true);
  draw_series(canvas, frame, series);
  if (level > 0) {
    const float y = frame.at(0, 1, level).y;
    canvas.AddLine({top_left.x, y}, {bottom_right.x, y}, kLevel);
  }
  canvas.PopClipRect();
  const std::string scale = fmt::format("{:g}{}", frame.top, unit);
  canvas.AddText({top_left.x + 4, top_left.y + 1}, kQuiet, scale.c_str());
  ImGui::Dummy(size);
}

void draw_bar(const char* name, float share, ImU32 colour, const std::string& text, float width) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const float height = ImGui::GetTextLineHeight();
  const float from = corner.x + 0.5F * width;
  const float room = 0.28F * width;
  canvas.AddText(corner, kText, name);
  canvas.AddRectFilled({from, corner.y + 4}, {from + room, corner.y + height - 2}, kChartGround, 2);
  canvas.AddRectFilled({from, corner.y + 4},
                       {from + std::clamp(share, 0.0F, 1.0F) * room, corner.y + height - 2}, colour,
                       2);
  const float text_width = ImGui::CalcTextSize(text.c_str()).x;
  canvas.AddText({corner.x + width - text_width, corner.y}, kText, text.c_str());
  ImGui::Dummy({width, height - 2});
}

}  // namespace ydd
