// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "ydd/window/panels.h"
#include "ydd/window/style.h"

namespace ydd {
namespace {

constexpr ImGuiWindowFlags kBar = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                  ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNavInputs;
constexpr const char* kForget = "Forget the map?";
constexpr const char* kEnd = "End the run?";

void tooltip(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

/// A button that looks pressed while `on`.
bool choice(const char* name, bool on) {
  if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetColorU32(ImGuiCol_ButtonActive));
  const bool pressed = ImGui::Button(name);
  if (on) ImGui::PopStyleColor();
  ImGui::SameLine(0, 2);
  return pressed;
}

void gap() { ImGui::SameLine(0, 18); }

void draw_playback(const LiveStatus& status, PanelRequests& requests) {
  ImGui::BeginDisabled(status.finished);
  const float width = ImGui::CalcTextSize("Resume").x + 20;
  if (ImGui::Button(status.paused ? "Resume" : "Pause", {width, 0})) {
    requests.commands.push_back(status.paused ? LiveCommand(live::Resume{})
                                              : LiveCommand(live::Pause{}));
  }
  tooltip("Space");
  ImGui::SameLine();
  if (ImGui::Button("Step")) requests.commands.emplace_back(live::Step{});
  tooltip("One frame, then pause (S)");
  ImGui::SameLine();
  if (ImGui::Button("Reset")) ImGui::OpenPopup(kForget);
  tooltip("Forget map and trajectory and start afresh (R)");
  ImGui::SameLine();
  if (ImGui::Button("End")) ImGui::OpenPopup(kEnd);
  tooltip("End the run now; its results are written");
  ImGui::EndDisabled();
}

void draw_variants(const PanelFacts& facts, PanelRequests& requests) {
  gap();
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("reject");
  ImGui::SameLine();
  const LiveStatus& status = facts.live->status;
  const Variant now = facts.has_detector ? status.variant : without_boxes(status.variant);
  ImGui::BeginDisabled(status.finished);
  for (const Variant variant :
       {Variant::off, Variant::box, Variant::person, Variant::full, Variant::evidence}) {
    if (!facts.has_detector && needs_boxes(variant)) continue;
    const std::string name(to_string(variant));
    if (choice(name.c_str(), now == variant) && now != variant) {
      requests.commands.emplace_back(live::SetVariant{variant});
    }
    tooltip("What is rejected as moving, from the next frame on");
  }
  ImGui::EndDisabled();
}

void draw_map_controls(const LiveStatus& status, PanelRequests& requests) {
  gap();
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("map");
  ImGui::SameLine();
  ImGui::BeginDisabled(status.finished);
  if (choice("keep as is", status.localization_only)) {
    requests.commands.emplace_back(live::SetLocalizationOnly{!status.localization_only});
  }
  tooltip("Localisation only: use the map without changing it (L)");
  if (ImGui::Button("Save")) requests.commands.emplace_back(live::SaveMap{});
  tooltip("Save the map of now: --save-map's file, else map.ydd in the run's folder (M)");
  ImGui::EndDisabled();
}

void draw_eye(ViewState& state, PanelRequests& requests) {
  gap();
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("eye");
  ImGui::SameLine();
  struct Mode {
    const char* name;
    EyeMode mode;
    const char* help;
  };
  for (const Mode& m : {Mode{"follow", EyeMode::follow, "Stay with the camera (1)"},
                        Mode{"free", EyeMode::free, "Stay where the mouse puts it (2)"},
                        Mode{"top", EyeMode::top, "From above (3)"}}) {
    if (choice(m.name, state.eye == m.mode)) state.eye = m.mode;
    tooltip(m.help);
  }
  if (ImGui::Button("fit")) requests.fit = true;
  tooltip("See all of the map (F)");
}

/// Asks before something is done that cannot be undone.
void confirm(const char* title, const char* text, const char* yes, LiveCommand command,
             PanelRequests& requests) {
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  ImGui::TextUnformatted(text);
  ImGui::Spacing();
  if (ImGui::Button(yes)) {
    requests.commands.push_back(command);
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  if (ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace

void draw_toolbar(const PixelRect& where, const PanelFacts& facts, ViewState& state,
                  PanelRequests& requests) {
  ImGui::SetNextWindowPos({static_cast<float>(where.x), static_cast<float>(where.y)});
  ImGui::SetNextWindowSize({static_cast<float>(where.width), static_cast<float>(where.height)});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, 0U);
  ImGui::Begin("toolbar", nullptr, kBar);
  draw_playback(facts.live->status, requests);
  draw_variants(facts, requests);
  draw_map_controls(facts.live->status, requests);
  draw_eye(state, requests);
  gap();
  if (ImGui::Button("Screenshot")) requests.screenshot = true;
  tooltip("Into the run's folder (P)");
  if (requests.ask_reset) ImGui::OpenPopup(kForget);
  confirm(kForget, "Map and trajectory so far are forgotten;\nthe next frame starts a new map.",
          "Forget", live::Reset{}, requests);
  confirm(kEnd, "The remaining frames are not read;\nresults up to here are written.", "End",
          live::Quit{}, requests);
  ImGui::End();
  ImGui::PopStyleColor();
}

namespace {

void take_run_key(char key, const LiveStatus& status, PanelRequests& requests) {
  if (status.finished) return;
  if (key == ' ') {
    requests.commands.push_back(status.paused ? LiveCommand(live::Resume{})
                                              : LiveCommand(live::Pause{}));
  }
  if (key == 'S') requests.commands.emplace_back(live::Step{});
  if (key == 'R') requests.ask_reset = true;
  if (key == 'L') {
    requests.commands.emplace_back(live::SetLocalizationOnly{!status.localization_only});
  }
  if (key == 'M') requests.commands.emplace_back(live::SaveMap{});
}

}  // namespace

void take_key(char key, const PanelFacts& facts, ViewState& state, PanelRequests& requests) {
  if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) return;
  take_run_key(key, facts.live->status, requests);
  if (key == '1') state.eye = EyeMode::follow;
  if (key == '2') state.eye = EyeMode::free;
  if (key == '3') state.eye = EyeMode::top;
  if (key == 'F') requests.fit = true;
  if (key == 'D') state.dense = !state.dense;
  if (key == 'P') requests.screenshot = true;
  if (key == 'Q') requests.close = true;
}

}  // namespace ydd
