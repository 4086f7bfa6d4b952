// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace ydd::sim {
namespace {

std::uint32_t pack(const Colour& colour) {
  const Colour c = colour.max(0.0F).min(1.0F) * 255.0F + 0.5F;
  return static_cast<std::uint32_t>(c[0]) | (static_cast<std::uint32_t>(c[1]) << 8U) |
         (static_cast<std::uint32_t>(c[2]) << 16U);
}

Eigen::Array4f unpack(std::uint32_t texel) {
  const auto bytes = std::bit_cast<std::array<std::uint8_t, 4>>(texel);
  return {static_cast<float>(bytes[0]), static_cast<float>(bytes[1]), static_cast<float>(bytes[2]),
          0.0F};
}

std::vector<std::uint32_t> halve(const std::vector<std::uint32_t>& texels, int width, int height) {
  const int half_width = std::max(1, width / 2);
  const int half_height = std::max(1, height / 2);
  std::vector<std::uint32_t> result(static_cast<std::size_t>(half_width) * half_height);
  for (int y = 0; y < half_height; ++y) {
    const std::uint32_t* upper = &texels[static_cast<std::size_t>(2 * y) * width];
    const std::uint32_t* lower = height > 1 ? upper + width : upper;
    for (int x = 0; x < half_width; ++x) {
      const int left = 2 * x;
      const int right = width > 1 ? left + 1 : left;
      std::uint32_t mean = 0;
      for (unsigned shift = 0; shift < 24; shift += 8) {
        const auto byte = [shift](std::uint32_t t) { return (t >> shift) & 0xFFU; };
        const std::uint32_t sum =
            byte(upper[left]) + byte(upper[right]) + byte(lower[left]) + byte(lower[right]);
        mean |= ((sum + 2) / 4) << shift;
      }
      result[static_cast<std::size_t>(y) * half_width + x] = mean;
    }
  }
  return result;
}

/// Base-two logarithm, within 0.06: level selection needs no more.
float quick_log2(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  return static_cast<float>(bits) * (1.0F / 8388608.0F) - 126.957F;
}

}  // namespace

Texture::Texture(const Canvas& canvas, Wrap wrap) : wrap_(wrap) {
  const int width = canvas.width();
  const int height = canvas.height();
  const bool powers = std::has_single_bit(static_cast<unsigned>(width)) &&
                      std::has_single_bit(static_cast<unsigned>(height));
  if (wrap == Wrap::repeat && !powers) {
    throw std::logic_error("Texture: a repeating texture needs power-of-two sides");
  }
  Level level{width, height, {}};
  level.texels.reserve(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) level.texels.push_back(pack(canvas.at(x, y)));
  }
  levels_.push_back(std::move(level));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2),
                 halve(fine.texels, fine.width, fine.height)};
    levels_.push_back(std::move(coarse));
  }
}

Eigen::Array4f Texture::bilinear(const Level& level, float u, float v) const {
  const float x = std::floor(u - 0.5F);
  const float y = std::floor(v - 0.5F);
  const float fx = u - 0.5F - x;
  const float fy = v - 0.5F - y;
  int x0 = static_cast<int>(x);
  int y0 = static_cast<int>(y);
  int x1 = x0 + 1;
  int y1 = y0 + 1;
  if (wrap_ == Wrap::repeat) {
    x0 &= level.width - 1;
    x1 &= level.width - 1;
    y0 &= level.height - 1;
    y1 &= level.height - 1;
  } else {
    x0 = std::clamp(x0, 0, level.width - 1);
    x1 = std::clamp(x1, 0, level.width - 1);
    y0 = std::clamp(y0, 0, level.height - 1);
    y1 = std::clamp(y1, 0, level.height - 1);
  }
  const std::uint32_t* upper = &level.texels[static_cast<std::size_t>(y0) * level.width];
  const std::uint32_t* lower = &level.texels[static_cast<std::size_t>(y1) * level.width];
  const Eigen::Array4f top = unpack(upper[x0]) * (1.0F - fx) + unpack(upper[x1]) * fx;
  const Eigen::Array4f bottom = unpack(lower[x0]) * (1.0F - fx) + unpack(lower[x1]) * fx;
  return top * (1.0F - fy) + bottom * fy;
}

Eigen::Array4f Texture::trilinear(float u, float v, float lod) const {
  const auto last = static_cast<int>(levels_.size()) - 1;
  if (lod <= 0.0F) return bilinear(levels_[0], u, v);
  const int fine = std::min(static_cast<int>(lod), last);
  const float scale = std::ldexp(1.0F, -fine);
  const Eigen::Array4f near = bilinear(levels_[fine], u * scale, v * scale);
  if (fine == last) return near;
  const Eigen::Array4f far = bilinear(levels_[fine + 1], u * scale * 0.5F, v * scale * 0.5F);
  return near + (lod - static_cast<float>(fine)) * (far - near);
}

Colour Texture::sample(float u, float v, const Footprint& footprint) const {
  constexpr float kMaxProbes = 4.0F;
  // Half a level sharper than a square pixel asks for: trilinear filtering alone looks soft.
  constexpr float kBias = -0.5F;
  float major2 = footprint.along_x.squaredNorm();
  float minor2 = footprint.along_y.squaredNorm();
  Vector2 axis = footprint.along_x;
  if (minor2 > major2) {
    std::swap(major2, minor2);
    axis = footprint.along_y;
  }
  constexpr float kTiny = 1e-12F;
  major2 = std::max(major2, kTiny);
  const float narrow2 = std::max(minor2, major2 / (kMaxProbes * kMaxProbes));
  const float lod = 0.5F * quick_log2(narrow2) + kBias;
  const int probes = static_cast<int>(std::sqrt(major2 / narrow2) + 0.5F);
  if (probes <= 1) return trilinear(u, v, lod).head<3>();
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (int i = 0; i < probes; ++i) {
    const float t = (static_cast<float>(i) + 0.5F) / static_cast<float>(probes) - 0.5F;
    sum += trilinear(u + t * axis.x(), v + t * axis.y(), lod);
  }
  return (sum / static_cast<float>(probes)).head<3>();
}

}  // namespace ydd::sim
