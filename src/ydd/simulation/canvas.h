// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ydd/simulation/random.h"

namespace ydd::sim {

/// Blue, green, red in [0, 1], display-referred.
using Colour = Eigen::Array3f;
using Vector2 = Eigen::Vector2f;

inline Colour bgr(float b, float g, float r) { return {b, g, r}; }
inline Colour grey(float value) { return Colour::Constant(value); }
/// Hue in turns, saturation and value in [0, 1].
Colour hsv(float hue, float saturation, float value);

/// A picture to paint on; the origin is the upper left corner, units are texels, shapes are
/// anti-aliased and clipped.
class Canvas {
 public:
  Canvas(int width, int height, const Colour& colour);

  int width() const { return width_; }
  int height() const { return height_; }
  const Colour& at(int x, int y) const { return texels_[index(x, y)]; }
  Colour& at(int x, int y) { return texels_[index(x, y)]; }

  /// Value noise with cubic fade (Perlin's lattice scheme on values): a lattice of `cell` texels,
  /// added times `amplitude`. `stretch` widens the cells along x (wood grain, brushed metal).
  void add_noise(Random& random, float cell, const Colour& amplitude, float stretch = 1.0F);
  /// Octaves of `add_noise` from `cell` downwards, each half the size and `gain` times as strong.
  void add_octaves(Random& random, float cell, const Colour& amplitude, int octaves,
                   float gain = 0.6F, float stretch = 1.0F);
  void fill_rectangle(const Vector2& centre, const Vector2& half_size, float angle_rad,
                      const Colour& colour, float alpha = 1.0F);
  /// Corner to corner, axis-parallel.
  void fill_box(float x0, float y0, float x1, float y1, const Colour& colour, float alpha = 1.0F);
  void fill_ellipse(const Vector2& centre, const Vector2& radii, float angle_rad,
                    const Colour& colour, float alpha = 1.0F);
  void stroke(const Vector2& from, const Vector2& to, float width, const Colour& colour,
              float alpha = 1.0F);
  /// Lines of invented letters in a box. Letters are `letter` texels high.
  void write_text(Random& random, float x0, float y0, float x1, float y1, float letter,
                  const Colour& colour);
  /// Copies `other` with its upper left corner at (x, y), clipped.
  void paste(const Canvas& other, int x, int y);

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  /// Blends `colour` where `distance(x, y)`, in texels, is negative, with a soft rim of one texel.
  template <class Distance>
  void fill(const Vector2& low, const Vector2& high, const Colour& colour, float alpha,
            const Distance& distance);
  void write_letter(std::uint64_t shape, float x, float y, float height, const Colour& colour);

  int width_;
  int height_;
  std::vector<Colour> texels_;
};

}  // namespace ydd::sim
