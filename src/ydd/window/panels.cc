// SPDX-License-Identifier: Apache-2.0
#include "ydd/window/panels.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "ydd/pictures/annotate.h"
#include "ydd/window/charts.h"
#include "ydd/window/style.h"

namespace ydd {
namespace {

constexpr ImGuiWindowFlags kFixed =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoNavInputs | ImGuiWindowFlags_NoBringToFrontOnFocus;
constexpr ImU32 kStageColour = IM_COL32(80, 160, 255, 220);
constexpr ImU32 kTimeColour = IM_COL32(80, 160, 255, 255);
constexpr ImU32 kKeptColour = IM_COL32(60, 190, 90, 200);
constexpr ImU32 kRejectedColour = IM_COL32(255, 70, 90, 200);
constexpr ImU32 kRequestedColour = IM_COL32(240, 240, 240, 160);

ImVec2 corner_of(const PixelRect& r) { return {static_cast<float>(r.x), static_cast<float>(r.y)}; }
ImVec2 size_of(const PixelRect& r) {
  return {static_cast<float>(r.width), static_cast<float>(r.height)};
}

void begin_fixed(const char* name, const PixelRect& where, ImGuiWindowFlags flags = 0) {
  ImGui::SetNextWindowPos(corner_of(where));
  ImGui::SetNextWindowSize(size_of(where));
  ImGui::Begin(name, nullptr, kFixed | flags);
}

void draw_time_chart(const PanelFacts& facts, ImVec2 size) {
  ChartSeries total{"now", {}, kTimeColour, false};
  for (const LiveSample& s : facts.recent) total.values.push_back(s.total_ms);
  draw_chart("Frame time", std::array{total}, 1000.0F / 30, " ms", size);
}

void draw_feature_chart(const PanelFacts& facts, ImVec2 size) {
  ChartSeries kept{"kept", {}, kKeptColour, true};
  ChartSeries rejected{"rejected", {}, kRejectedColour, true};
  ChartSeries requested{"", {}, kRequestedColour, false};
  for (const LiveSample& s : facts.recent) {
    kept.values.push_back(static_cast<float>(s.kept));
    rejected.values.push_back(static_cast<float>(s.rejected));
    requested.values.push_back(static_cast<float>(s.requested));
  }
  draw_chart("Points", std::array{kept, rejected, requested}, 0, "", size);
}

/// The stages of this frame that took longest.
void draw_stages(const PanelFacts& facts, float width, int rows) {
  std::vector<std::pair<double, std::string>> stages;
  double longest_ms = 1e-3;
  for (const StageTime& t : facts.live->report->times) {
    if (t.stage == "total") continue;
    stages.emplace_back(t.wall_ms, t.stage);
    longest_ms = std::max(longest_ms, t.wall_ms);
  }
  std::stable_sort(stages.begin(), stages.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; i < stages.size() && static_cast<int>(i) < rows; ++i) {
    std::string name = stages[i].second;
    std::replace(name.begin(), name.end(), '_', ' ');
    draw_bar(name.c_str(), static_cast<float>(stages[i].first / longest_ms), kStageColour,
             fmt::format("{:.1f} ms", stages[i].first), width);
  }
}

/// How many points each rule rejected in this frame; colours as in the picture.
void draw_rules(const PanelFacts& facts, float width, int rows) {
  const auto counts = count_rules(*facts.live->report->filtered);
  std::vector<std::pair<int, Rule>> rules;
  for (std::size_t i = 1; i < counts.size(); ++i) {
    if (counts[i] > 0) rules.emplace_back(counts[i], static_cast<Rule>(i));
  }
  std::stable_sort(rules.begin(), rules.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; i < rules.size() && static_cast<int>(i) < rows; ++i) {
    std::string name(to_string(rules[i].second));
    std::replace(name.begin(), name.end(), '_', ' ');
    draw_bar(name.c_str(), static_cast<float>(rules[i].first) / static_cast<float>(rules[0].first),
             colour(colour_of(rules[i].second)), fmt::format("{}", rules[i].first), width);
  }
  if (rules.empty()) ImGui::TextDisabled("nothing rejected in this frame");
}

struct Mood {
  const char* name;
  Rgba colour;
};

Mood mood_of(const LiveFrame& live) {
  if (live.status.finished) return {"FINISHED", {150, 190, 255, 255}};
  if (live.status.paused) return {"PAUSED", {255, 200, 60, 255}};
  switch (live.report->track.state) {
    case TrackingState::tracking:
      return {"TRACKING", scene_colour::kTracking};
    case TrackingState::coasting:
      return {"COASTING", {255, 200, 60, 255}};
    case TrackingState::lost:
      return {"LOST", scene_colour::kLost};
    case TrackingState::initializing:
      break;
  }
  return {"STARTING", {255, 200, 60, 255}};
}

void draw_pill(const Mood& mood) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 text = ImGui::CalcTextSize(mood.name);
  const ImVec2 end(corner.x + text.x + 18, corner.y + text.y + 6);
  canvas.AddRectFilled(corner, end, colour(mood.colour), 4);
  canvas.AddText({corner.x + 9, corner.y + 3}, IM_COL32(10, 14, 20, 255), mood.name);
  ImGui::Dummy({text.x + 18, text.y + 6});
}

void draw_state(const PanelFacts& facts) {
  const LiveFrame& live = *facts.live;
  draw_pill(mood_of(live));
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(facts.sequence.c_str());
  ImGui::Text("frame %lld of %zu", static_cast<long long>(live.report->index) + 1, facts.frames);
  if (live.status.frames_per_second > 0) {
    ImGui::SameLine();
    ImGui::Text("  %.1f per second", live.status.frames_per_second);
  }
  ImGui::Text("%d keyframes  %d points", facts.keyframes, facts.points);
  if (facts.loops > 0) ImGui::Text("%d loop edges", facts.loops);
  if (facts.maps > 1) ImGui::Text("%d maps", facts.maps);
  if (facts.error_rmse_m) ImGui::Text("ATE so far %.1f cm", 100 * *facts.error_rmse_m);
  if (!facts.has_detector) {
    ImGui::TextDisabled(live.status.variant == Variant::evidence
                            ? "no detector: what is seen to move is rejected"
                            : "no detector: nothing is rejected");
  }
  if (!live.status.message.empty()) ImGui::TextDisabled("%s", live.status.message.c_str());
}

void draw_layer(const char* name, Rgba chip, bool& on) {
  ImGui::Checkbox(name, &on);
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const ImVec2 low = ImGui::GetItemRectMin();
  const ImVec2 high = ImGui::GetItemRectMax();
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowWidth() - 10;
  const float middle = (low.y + high.y) / 2;
  chip[3] = 255;
  canvas.AddRectFilled({right - 16, middle - 2}, {right, middle + 2}, colour(chip), 2);
}

void draw_layers(const PanelFacts& facts, ViewState& state, bool has_loops) {
  draw_layer("points", scene_colour::kPoint, state.points);
  draw_layer("keyframes", scene_colour::kKeyframe, state.keyframes);
  draw_layer("shared views", scene_colour::kCovisibility, state.covisibility);
  if (has_loops) draw_layer("loops", scene_colour::kLoop, state.loops);
  draw_layer("trajectory", scene_colour::kTrajectory, state.trajectory);
  if (facts.has_truth) {
    draw_layer("ground truth", scene_colour::kTruth, state.truth);
    draw_layer("error", scene_colour::kError, state.errors);
  }
  draw_layer("people, things", scene_colour::kTrack, state.tracks);
  ImGui::Checkbox("floor grid", &state.grid);
  ImGui::Checkbox("dense cloud", &state.dense);
}

/// Drags with the left button turn, with the right or middle button (or shift) move.
MapGesture gesture_here() {
  MapGesture gesture;
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered()) gesture.zoom_steps = io.MouseWheel;
  if (!ImGui::IsItemActive()) return gesture;
  const bool left = ImGui::IsMouseDown(ImGuiMouseButton_Left);
  if (left && !io.KeyShift) {
    gesture.orbit_x = io.MouseDelta.x;
    gesture.orbit_y = io.MouseDelta.y;
  } else {
    gesture.pan_x = io.MouseDelta.x;
    gesture.pan_y = io.MouseDelta.y;
  }
  return gesture;
}

void begin_note(const char* name, ImVec2 at, ImVec2 pivot) {
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
  ImGui::SetNextWindowBgAlpha(0.72F);
  ImGui::Begin(name, nullptr,
               (kFixed | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing) &
                   ~ImGuiWindowFlags_NoBringToFrontOnFocus);
}

}  // namespace

void draw_picture(const PixelRect& where, const gl::Texture& picture) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  begin_fixed("picture", where, ImGuiWindowFlags_NoInputs);
  // ImGui's texture names are pointers; OpenGL's are numbers.
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(picture.id())),
               size_of(where));
  ImGui::End();
  ImGui::PopStyleVar();
}

void draw_charts(const PixelRect& where, const PanelFacts& facts) {
  begin_fixed("charts", where);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float gap = 20;
  const float width = (room.x - gap) / 2;
  const float chart_height = std::max(60.0F, 0.46F * room.y);
  const float row = ImGui::GetTextLineHeight() - 2 + ImGui::GetStyle().ItemSpacing.y;
  const int rows = std::max(0, static_cast<int>((room.y - chart_height - 6) / row));
  ImGui::BeginGroup();
  draw_time_chart(facts, {width, chart_height});
  draw_stages(facts, width, rows);
  ImGui::EndGroup();
  ImGui::SameLine(0, gap);
  ImGui::BeginGroup();
  draw_feature_chart(facts, {width, chart_height});
  draw_rules(facts, width, rows);
  ImGui::EndGroup();
  ImGui::End();
}

void draw_labels(const PixelRect& where, const std::vector<MapView::PlacedLabel>& labels) {
  ImDrawList& canvas = *ImGui::GetBackgroundDrawList();
  const ImVec2 low = corner_of(where), size = size_of(where);
  canvas.PushClipRect(low, {low.x + size.x, low.y + size.y});
  for (const MapView::PlacedLabel& placed : labels) {
    const ImVec2 text = ImGui::CalcTextSize(placed.label->text.c_str());
    const ImVec2 at(low.x + static_cast<float>(placed.x) * size.x - 0.5F * text.x,
                    low.y + static_cast<float>(placed.y) * size.y - text.y);
    canvas.AddText({at.x + 1, at.y + 1}, IM_COL32(0, 0, 0, 200), placed.label->text.c_str());
    canvas.AddText(at, colour(placed.label->colour), placed.label->text.c_str());
  }
  canvas.PopClipRect();
}

MapGesture draw_map_overlay(const PixelRect& where, const PanelFacts& facts, ViewState& state,
                            bool has_loops) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  begin_fixed("map", where, ImGuiWindowFlags_NoBackground);
  ImGui::InvisibleButton("turn", size_of(where),
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  const MapGesture gesture = gesture_here();
  ImGui::End();
  ImGui::PopStyleVar();
  const ImVec2 corner = corner_of(where);
  begin_note("state", {corner.x + 8, corner.y + 8}, {0, 0});
  draw_state(facts);
  ImGui::End();
  ImGui::SetNextWindowSizeConstraints({164, 0}, {400, 1000});
  begin_note("layers", {corner.x + static_cast<float>(where.width) - 8, corner.y + 8}, {1, 0});
  draw_layers(facts, state, has_loops);
  ImGui::End();
  return gesture;
}

}  // namespace ydd
