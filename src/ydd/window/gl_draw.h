// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "ydd/image/image.h"
#include "ydd/viewer/map_scene.h"

/// The little of OpenGL 3.3 that the window needs. Thread: the one whose context is current, also
/// when these go.
namespace ydd::gl {

/// A rectangle of the window in pixels of its frame buffer, origin bottom left.
struct Viewport {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Vertices that live on the graphics card.
class VertexBuffer {
 public:
  VertexBuffer();
  ~VertexBuffer();
  VertexBuffer(VertexBuffer&& other) noexcept;
  VertexBuffer& operator=(VertexBuffer&&) = delete;
  VertexBuffer(const VertexBuffer&) = delete;
  VertexBuffer& operator=(const VertexBuffer&) = delete;

  void upload(const Vertices& vertices);
  std::size_t size() const { return size_; }

 private:
  friend class Painter;
  std::uint32_t array_ = 0;
  std::uint32_t buffer_ = 0;
  std::size_t size_ = 0;
};

/// Draws points and lines.
class Painter {
 public:
  Painter();
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Everything until `end` goes into the viewport, whose background is cleared.
  void begin(const Viewport& viewport);
  void end();
  /// What follows is drawn over everything before, however far away it is.
  void on_top();
  void points(const VertexBuffer& points, const Eigen::Matrix4d& clip_from_world, float size_px);
  void lines(const VertexBuffer& lines, const Eigen::Matrix4d& clip_from_world, float width_px);

 private:
  void draw(const VertexBuffer& buffer, const Eigen::Matrix4d& clip_from_world, float size_px,
            bool points);
  std::uint32_t program_ = 0;
  int matrix_ = -1;
  int point_size_ = -1;
  int round_ = -1;
};

/// A picture on the graphics card.
class Texture {
 public:
  Texture();
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  void upload(const ColourImage& image);
  std::uint32_t id() const { return id_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  std::uint32_t id_ = 0;
  int width_ = 0, height_ = 0;
};

/// Clears the whole frame buffer.
void clear_window(int width_px, int height_px);
/// What is in the back buffer.
ColourImage read_window(int width_px, int height_px);

}  // namespace ydd::gl
