// SPDX-License-Identifier: Apache-2.0
#include "ydd/window/gl_draw.h"

#include <array>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

namespace ydd::gl {
namespace {

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 p_world;
layout(location = 1) in vec4 rgba;
uniform mat4 clip_from_world;
uniform float point_size;
out vec4 colour;
void main() {
  gl_Position = clip_from_world * vec4(p_world, 1.0);
  gl_PointSize = point_size;
  colour = rgba;
}
)";

constexpr const char* kFragmentShader = R"(#version 330 core
in vec4 colour;
uniform bool round_points;
out vec4 pixel;
void main() {
  if (round_points && length(gl_PointCoord - vec2(0.5)) > 0.5) discard;
  pixel = colour;
}
)";

constexpr float kGround = 0.055F;  // of the map; the panels are a little lighter

std::uint32_t compile(GLenum kind, const char* source) {
  const std::uint32_t shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  int compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == 0) {
    std::array<char, 512> reason{};
    glGetShaderInfoLog(shader, static_cast<int>(reason.size()), nullptr, reason.data());
    throw std::logic_error(std::string("shader: ") + reason.data());
  }
  return shader;
}

}  // namespace

VertexBuffer::VertexBuffer() {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &buffer_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(SceneVertex), nullptr);
  glEnableVertexAttribArray(1);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset, says OpenGL
  const auto* const offset = reinterpret_cast<const void*>(offsetof(SceneVertex, rgba));
  glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(SceneVertex), offset);
  glBindVertexArray(0);
}

VertexBuffer::VertexBuffer(VertexBuffer&& other) noexcept
    : array_(std::exchange(other.array_, 0)),
      buffer_(std::exchange(other.buffer_, 0)),
      size_(std::exchange(other.size_, 0)) {}

VertexBuffer::~VertexBuffer() {
  // Zero, of what was moved from, is ignored.
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &buffer_);
}

void VertexBuffer::upload(const Vertices& vertices) {
  size_ = vertices.size();
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(size_ * sizeof(SceneVertex)),
               vertices.data(), GL_DYNAMIC_DRAW);
}

Painter::Painter() : program_(glCreateProgram()) {
  const std::uint32_t vertex = compile(GL_VERTEX_SHADER, kVertexShader);
  const std::uint32_t fragment = compile(GL_FRAGMENT_SHADER, kFragmentShader);
  glAttachShader(program_, vertex);
  glAttachShader(program_, fragment);
  glLinkProgram(program_);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  matrix_ = glGetUniformLocation(program_, "clip_from_world");
  point_size_ = glGetUniformLocation(program_, "point_size");
  round_ = glGetUniformLocation(program_, "round_points");
}

Painter::~Painter() { glDeleteProgram(program_); }

void Painter::begin(const Viewport& viewport) {
  glViewport(viewport.x, viewport.y, viewport.width, viewport.height);
  glScissor(viewport.x, viewport.y, viewport.width, viewport.height);
  glEnable(GL_SCISSOR_TEST);
  glClearColor(kGround, kGround, kGround * 1.25F, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glUseProgram(program_);
}

void Painter::end() {
  glUseProgram(0);
  glBindVertexArray(0);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
}

void Painter::on_top() { glDisable(GL_DEPTH_TEST); }

void Painter::points(const VertexBuffer& points, const Eigen::Matrix4d& clip_from_world,
                     float size_px) {
  draw(points, clip_from_world, size_px, true);
}

void Painter::lines(const VertexBuffer& lines, const Eigen::Matrix4d& clip_from_world,
                    float width_px) {
  draw(lines, clip_from_world, width_px, false);
}

void Painter::draw(const VertexBuffer& buffer, const Eigen::Matrix4d& clip_from_world,
                   float size_px, bool points) {
  if (buffer.size() == 0) return;
  const Eigen::Matrix4f matrix = clip_from_world.cast<float>();
  glUniformMatrix4fv(matrix_, 1, GL_FALSE, matrix.data());
  glUniform1f(point_size_, size_px);
  glUniform1i(round_, points && size_px > 2.5F ? 1 : 0);
  if (!points) glLineWidth(size_px);
  glBindVertexArray(buffer.array_);
  glDrawArrays(points ? GL_POINTS : GL_LINES, 0, static_cast<GLsizei>(buffer.size()));
}

Texture::Texture() {
  glGenTextures(1, &id_);
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

Texture::~Texture() { glDeleteTextures(1, &id_); }

void Texture::upload(const ColourImage& image) {
  glBindTexture(GL_TEXTURE_2D, id_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (image.width() == width_ && image.height() == height_) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_BGR, GL_UNSIGNED_BYTE,
                    image.data());
    return;
  }
  width_ = image.width();
  height_ = image.height();
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width_, height_, 0, GL_BGR, GL_UNSIGNED_BYTE,
               image.data());
}

void clear_window(int width_px, int height_px) {
  glViewport(0, 0, width_px, height_px);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0.08F, 0.085F, 0.1F, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

ColourImage read_window(int width_px, int height_px) {
  std::vector<Bgr> upside_down(static_cast<std::size_t>(width_px) *
                               static_cast<std::size_t>(height_px));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_px, height_px, GL_BGR, GL_UNSIGNED_BYTE, upside_down.data());
  std::vector<Bgr> pixels;
  pixels.reserve(upside_down.size());
  for (int y = height_px - 1; y >= 0; --y) {
    const auto row = upside_down.begin() + static_cast<std::ptrdiff_t>(y) * width_px;
    pixels.insert(pixels.end(), row, row + width_px);
  }
  return {width_px, height_px, std::move(pixels)};
}

}  // namespace ydd::gl
