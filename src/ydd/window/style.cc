// SPDX-License-Identifier: Apache-2.0
#include "ydd/window/style.h"

#include <array>
#include <filesystem>

namespace ydd {
namespace {

constexpr float kFontSize_px = 15;
// Where Debian, Fedora and Arch put it.
constexpr std::array kFonts = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                               "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                               "/usr/share/fonts/TTF/DejaVuSans.ttf"};

void apply_colours(ImVec4* colours) {
  colours[ImGuiCol_Text] = {0.9F, 0.91F, 0.94F, 1};
  colours[ImGuiCol_TextDisabled] = {0.56F, 0.6F, 0.66F, 1};
  colours[ImGuiCol_WindowBg] = {0.105F, 0.112F, 0.132F, 1};
  colours[ImGuiCol_PopupBg] = {0.14F, 0.15F, 0.175F, 1};
  colours[ImGuiCol_Border] = {1, 1, 1, 0.07F};
  colours[ImGuiCol_FrameBg] = {1, 1, 1, 0.07F};
  colours[ImGuiCol_FrameBgHovered] = {1, 1, 1, 0.12F};
  colours[ImGuiCol_FrameBgActive] = {1, 1, 1, 0.16F};
  colours[ImGuiCol_Button] = {1, 1, 1, 0.08F};
  colours[ImGuiCol_ButtonHovered] = {0.31F, 0.55F, 0.95F, 0.55F};
  colours[ImGuiCol_ButtonActive] = {0.31F, 0.55F, 0.95F, 0.85F};
  colours[ImGuiCol_CheckMark] = {0.45F, 0.68F, 1, 1};
  colours[ImGuiCol_Separator] = {1, 1, 1, 0.09F};
  colours[ImGuiCol_ModalWindowDimBg] = {0, 0, 0, 0.5F};
}

}  // namespace

void apply_style(float scale) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 5;
  style.FrameRounding = 4;
  style.PopupRounding = 5;
  style.WindowBorderSize = 0;
  style.WindowPadding = {9, 8};
  style.FramePadding = {9, 5};
  style.ItemSpacing = {7, 6};
  style.ItemInnerSpacing = {6, 4};
  apply_colours(style.Colors);
  style.ScaleAllSizes(scale);
}

void load_font(float scale) {
  const ImGuiIO& io = ImGui::GetIO();
  for (const char* const file : kFonts) {
    // ImGui would stop the program at a file that is not there.
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) continue;
    if (io.Fonts->AddFontFromFileTTF(file, kFontSize_px * scale)) return;
  }
  io.Fonts->AddFontDefault();
}

}  // namespace ydd
