// SPDX-License-Identifier: Apache-2.0
#include "ydd/window/glfw_window.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "ydd/window/style.h"

namespace ydd {
namespace {

constexpr const char* kShadingLanguage = "#version 330 core";

std::string glfw_reason() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "unknown reason";
}

Error no_window(const std::string& reason) {
  return Error{fmt::format(
      "--view: no window can be opened ({}); run without --view, or under a virtual screen: "
      "xvfb-run -a ydd-slam run ...",
      reason)};
}

void start_imgui(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // no file beside the user's data
  float scale = 1;
  glfwGetWindowContentScale(window, &scale, nullptr);
  scale = std::clamp(scale, 1.0F, 3.0F);
  apply_style(scale);
  load_font(scale);
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init(kShadingLanguage);
}

}  // namespace

struct GlfwWindow::Input {
  bool any = false;
  std::vector<char> keys;

  static Input& of(GLFWwindow* window) {
    return *static_cast<Input*>(glfwGetWindowUserPointer(window));
  }
  void key(int key, int action) {
    any = true;
    const bool down = action == GLFW_PRESS || (action == GLFW_REPEAT && key == GLFW_KEY_S);
    if (down && key >= GLFW_KEY_SPACE && key <= GLFW_KEY_Z) keys.push_back(static_cast<char>(key));
  }
};

/// ImGui's own callbacks, installed later, call these as well.
void GlfwWindow::watch(GLFWwindow* window, Input& input) {
  glfwSetWindowUserPointer(window, &input);
  glfwSetKeyCallback(
      window, [](GLFWwindow* w, int key, int, int action, int) { Input::of(w).key(key, action); });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double, double) { Input::of(w).any = true; });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int, int) { Input::of(w).any = true; });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double) { Input::of(w).any = true; });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { Input::of(w).any = true; });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { Input::of(w).any = true; });
}

Result<GlfwWindow> GlfwWindow::open(int width_px, int height_px, const char* title) {
  if (glfwInit() == GLFW_FALSE) return no_window(glfw_reason());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SAMPLES, 4);
  GLFWwindow* window = glfwCreateWindow(width_px, height_px, title, nullptr, nullptr);
  if (!window) {
    const std::string reason = glfw_reason();
    glfwTerminate();
    return no_window(reason);
  }
  glfwSetWindowSizeLimits(window, 640, 480, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwMakeContextCurrent(window);
  glfwSwapInterval(0);  // redraws are paced by whoever draws, never by the screen
  glEnable(GL_MULTISAMPLE);
  auto input = std::make_unique<Input>();
  watch(window, *input);
  start_imgui(window);
  return GlfwWindow(window, std::move(input));
}

GlfwWindow::GlfwWindow(GLFWwindow* window, std::unique_ptr<Input> input)
    : window_(window), input_(std::move(input)) {}

GlfwWindow::GlfwWindow(GlfwWindow&& other) noexcept
    : window_(std::exchange(other.window_, nullptr)), input_(std::move(other.input_)) {}

GlfwWindow& GlfwWindow::operator=(GlfwWindow&& other) noexcept {
  std::swap(window_, other.window_);
  std::swap(input_, other.input_);
  return *this;
}

GlfwWindow::~GlfwWindow() {
  if (!window_) return;
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool GlfwWindow::wait_for_input(double seconds) {
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
  return std::exchange(input_->any, false);
}

std::vector<char> GlfwWindow::take_keys() { return std::exchange(input_->keys, {}); }

bool GlfwWindow::closing() const { return glfwWindowShouldClose(window_) != 0; }

void GlfwWindow::close() const { glfwSetWindowShouldClose(window_, GLFW_TRUE); }

GlfwWindow::Size GlfwWindow::size() const {
  Size size;
  glfwGetFramebufferSize(window_, &size.width_px, &size.height_px);
  return size;
}

void GlfwWindow::begin_frame() const {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void GlfwWindow::draw_panels() const {
  ImGui::Render();
  const Size now = size();
  glViewport(0, 0, now.width_px, now.height_px);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void GlfwWindow::present() const { glfwSwapBuffers(window_); }

}  // namespace ydd
