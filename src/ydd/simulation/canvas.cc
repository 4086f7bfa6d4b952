// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/canvas.h"

#include <algorithm>
#include <cmath>

namespace ydd::sim {
namespace {

float fade(float t) { return t * t * (3.0F - 2.0F * t); }

/// Random values in [-1, 1] on a lattice.
struct Lattice {
  Lattice(Random& random, int columns, int rows) : columns_(columns), values_(columns * rows) {
    for (float& value : values_) value = random.uniform_f(-1.0F, 1.0F);
  }
  float at(int column, int row) const { return values_[row * columns_ + column]; }

 private:
  int columns_;
  std::vector<float> values_;
};

}  // namespace

Colour hsv(float hue, float saturation, float value) {
  const float turn = (hue - std::floor(hue)) * 6.0F;
  const auto channel = [&](float offset) {
    const float k = std::fmod(offset + turn, 6.0F);
    return value - value * saturation * std::clamp(std::min(k, 4.0F - k), 0.0F, 1.0F);
  };
  return bgr(channel(1.0F), channel(3.0F), channel(5.0F));
}

Canvas::Canvas(int width, int height, const Colour& colour)
    : width_(std::max(1, width)),
      height_(std::max(1, height)),
      texels_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), colour) {}

void Canvas::add_noise(Random& random, float cell, const Colour& amplitude, float stretch) {
  const float step_x = 1.0F / std::max(1.0F, cell * stretch);
  const float step_y = 1.0F / std::max(1.0F, cell);
  const int columns = static_cast<int>(static_cast<float>(width_) * step_x) + 3;
  const int rows = static_cast<int>(static_cast<float>(height_) * step_y) + 3;
  const Lattice lattice(random, columns, rows);
  std::vector<float> line(columns);
  for (int y = 0; y < height_; ++y) {
    const float v = static_cast<float>(y) * step_y;
    const int row = static_cast<int>(v);
    const float weight = fade(v - static_cast<float>(row));
    for (int c = 0; c < columns; ++c) {
      line[c] = lattice.at(c, row) + weight * (lattice.at(c, row + 1) - lattice.at(c, row));
    }
    Colour* texel = &at(0, y);
    for (int x = 0; x < width_; ++x) {
      const float u = static_cast<float>(x) * step_x;
      const int column = static_cast<int>(u);
      const float t = fade(u - static_cast<float>(column));
      texel[x] += amplitude * (line[column] + t * (line[column + 1] - line[column]));
    }
  }
}

void Canvas::add_octaves(Random& random, float cell, const Colour& amplitude, int octaves,
                         float gain, float stretch) {
  Colour strength = amplitude;
  for (int i = 0; i < octaves && cell >= 1.0F; ++i) {
    add_noise(random, cell, strength, stretch);
    cell *= 0.5F;
    strength *= gain;
  }
}

template <class Distance>
void Canvas::fill(const Vector2& low, const Vector2& high, const Colour& colour, float alpha,
                  const Distance& distance) {
  const int x0 = std::max(0, static_cast<int>(std::floor(low.x() - 1.0F)));
  const int y0 = std::max(0, static_cast<int>(std::floor(low.y() - 1.0F)));
  const int x1 = std::min(width_ - 1, static_cast<int>(std::ceil(high.x() + 1.0F)));
  const int y1 = std::min(height_ - 1, static_cast<int>(std::ceil(high.y() + 1.0F)));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float d = distance(static_cast<float>(x), static_cast<float>(y));
      const float weight = alpha * std::clamp(0.5F - d, 0.0F, 1.0F);
      if (weight > 0.0F) at(x, y) += weight * (colour - at(x, y));
    }
  }
}

void Canvas::fill_rectangle(const Vector2& centre, const Vector2& half_size, float angle_rad,
                            const Colour& colour, float alpha) {
  const float c = std::cos(angle_rad);
  const float s = std::sin(angle_rad);
  const Vector2 reach(std::abs(c) * half_size.x() + std::abs(s) * half_size.y(),
                      std::abs(s) * half_size.x() + std::abs(c) * half_size.y());
  fill(centre - reach, centre + reach, colour, alpha, [&](float x, float y) {
    const float dx = x - centre.x();
    const float dy = y - centre.y();
    return std::max(std::abs(c * dx + s * dy) - half_size.x(),
                    std::abs(c * dy - s * dx) - half_size.y());
  });
}

void Canvas::fill_box(float x0, float y0, float x1, float y1, const Colour& colour, float alpha) {
  const Vector2 low(x0, y0);
  const Vector2 high(x1, y1);
  fill_rectangle(0.5F * (low + high), 0.5F * (high - low), 0.0F, colour, alpha);
}

void Canvas::fill_ellipse(const Vector2& centre, const Vector2& radii, float angle_rad,
                          const Colour& colour, float alpha) {
  const float c = std::cos(angle_rad);
  const float s = std::sin(angle_rad);
  const float scale = std::min(radii.x(), radii.y());
  const Vector2 reach = Vector2::Constant(radii.maxCoeff());
  fill(centre - reach, centre + reach, colour, alpha, [&](float x, float y) {
    const float dx = x - centre.x();
    const float dy = y - centre.y();
    const float u = (c * dx + s * dy) / radii.x();
    const float v = (c * dy - s * dx) / radii.y();
    return (std::sqrt(u * u + v * v) - 1.0F) * scale;
  });
}

void Canvas::stroke(const Vector2& from, const Vector2& to, float width, const Colour& colour,
                    float alpha) {
  const Vector2 along = to - from;
  const float length2 = std::max(1e-6F, along.squaredNorm());
  const Vector2 margin = Vector2::Constant(0.5F * width);
  fill(from.cwiseMin(to) - margin, from.cwiseMax(to) + margin, colour, alpha,
       [&](float x, float y) {
         const Vector2 p(x, y);
         const float t = std::clamp((p - from).dot(along) / length2, 0.0F, 1.0F);
         return (p - from - t * along).norm() - 0.5F * width;
       });
}

void Canvas::write_letter(std::uint64_t shape, float x, float y, float height,
                          const Colour& colour) {
  // Strokes between the nine knots of a 3 x 3 grid: shaped like letters, written in no language.
  constexpr int kStrokes = 4;
  const float width = 0.55F * height;
  const auto knot = [&](std::uint64_t k) {
    return Vector2(x + 0.5F * width * static_cast<float>(k % 3),
                   y + 0.5F * height * static_cast<float>(k / 3));
  };
  std::uint64_t from = shape % 9;
  for (int i = 0; i < kStrokes; ++i) {
    shape = mix_bits(shape);
    const std::uint64_t to = (from + 1 + shape % 8) % 9;
    stroke(knot(from), knot(to), std::max(1.0F, 0.17F * height), colour);
    from = shape % 3 == 0 ? (shape >> 8U) % 9 : to;
  }
}

void Canvas::write_text(Random& random, float x0, float y0, float x1, float y1, float letter,
                        const Colour& colour) {
  const float advance = 0.85F * letter;
  for (float y = y0; y + letter <= y1; y += 1.7F * letter) {
    const float end = random.chance(0.2) ? random.uniform_f(x0, x1) : x1;
    float x = x0;
    while (x + advance <= end) {
      const int letters = random.integer(2, 9);
      for (int i = 0; i < letters && x + advance <= end; ++i, x += advance) {
        write_letter(mix_bits(random.bits() % 26), x, y, letter, colour);
      }
      x += advance;
    }
  }
}

void Canvas::paste(const Canvas& other, int x, int y) {
  for (int row = std::max(0, -y); row < other.height() && y + row < height_; ++row) {
    for (int col = std::max(0, -x); col < other.width() && x + col < width_; ++col) {
      at(x + col, y + row) = other.at(col, row);
    }
  }
}

}  // namespace ydd::sim
