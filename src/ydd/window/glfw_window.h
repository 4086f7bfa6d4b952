// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ydd/base/result.h"

struct GLFWwindow;

namespace ydd {

/// Owns the window, its OpenGL context and ImGui's state. One at a time, in the main thread.
class GlfwWindow {
 public:
  /// One line says why there is none.
  static Result<GlfwWindow> open(int width_px, int height_px, const char* title);
  GlfwWindow(GlfwWindow&& other) noexcept;
  GlfwWindow& operator=(GlfwWindow&& other) noexcept;
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  ~GlfwWindow();

  /// Waits at most so long for the user. True when they did anything.
  bool wait_for_input(double seconds);
  /// Keys that went down since the last call, upper case, in order: also those that were up again
  /// before anything was drawn. S repeats while it is held.
  std::vector<char> take_keys();
  bool closing() const;
  void close() const;
  /// Size in pixels of the frame buffer.
  struct Size {
    int width_px = 0, height_px = 0;
  };
  Size size() const;

  void begin_frame() const;
  /// Draws ImGui's panels over what was drawn before.
  void draw_panels() const;
  void present() const;

 private:
  struct Input;  ///< what callbacks leave behind
  GlfwWindow(GLFWwindow* window, std::unique_ptr<Input> input);
  static void watch(GLFWwindow* window, Input& input);

  GLFWwindow* window_ = nullptr;
  std::unique_ptr<Input> input_;
};

}  // namespace ydd
