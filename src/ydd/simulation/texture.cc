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

// Four bytes to four floats in one go, where the processor can (GCC and Clang vector extension).
using Bytes4 = std::uint8_t __attribute__((vector_size(4)));
using Floats4 = float __attribute__((vector_size(16)));

Floats4 unpack(std::uint32_t texel) {
  return __builtin_convertvector(std::bit_cast<Bytes4>(texel), Floats4);
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

Floats4 bilinear(const MipLevel& level, Wrap wrap, float u, float v) {
  const float x = std::floor(u - 0.5F);
  const float y = std::floor(v - 0.5F);
  const float fx = u - 0.5F - x;
  const float fy = v - 0.5F - y;
  int x0 = static_cast<int>(x);
  int y0 = static_cast<int>(y);
  int x1 = x0 + 1;
  int y1 = y0 + 1;
  if (wrap == Wrap::repeat) {
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
  const Floats4 top = unpack(upper[x0]) * (1.0F - fx) + unpack(upper[x1]) * fx;
  const Floats4 bottom = unpack(lower[x0]) * (1.0F - fx) + unpack(lower[x1]) * fx;
  return top * (1.0F - fy) + bottom * fy;
}

Floats4 trilinear(const std::vector<MipLevel>& levels, Wrap wrap, float u, float v, float lod) {
  const auto last = static_cast<int>(levels.size()) - 1;
  if (lod <= 0.0F) return bilinear(levels[0], wrap, u, v);
  const int fine = std::min(static_cast<int>(lod), last);
  const float scale = std::ldexp(1.0F, -fine);
  const Floats4 near = bilinear(levels[fine], wrap, u * scale, v * scale);
  if (fine == last) return near;
  const Floats4 far = bilinear(levels[fine + 1], wrap, u * scale * 0.5F, v * scale * 0.5F);
  return near + (lod - static_cast<float>(fine)) * (far - near);
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
  MipLevel level{width, height, {}};
  level.texels.reserve(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) level.texels.push_back(pack(canvas.at(x, y)));
  }
  levels_.push_back(std::move(level));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const MipLevel& fine = levels_.back();
    MipLevel coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2),
                    halve(fine.texels, fine.width, fine.height)};
    levels_.push_back(std::move(coarse));
  }
}

Colour Texture::sample(float u, float v, const Footprint& footprint) const {
  constexpr float kMaxProbes = 4.0F;
  // A little sharper than a square pixel asks for: trilinear filtering alone looks soft.
  constexpr float kBias = -0.25F;
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
  const int probes = std::max(1, static_cast<int>(std::sqrt(major2 / narrow2) + 0.5F));
  Floats4 sum{};
  for (int i = 0; i < probes; ++i) {
    const float t = (static_cast<float>(i) + 0.5F) / static_cast<float>(probes) - 0.5F;
    sum += trilinear(levels_, wrap_, u + t * axis.x(), v + t * axis.y(), lod);
  }
  sum /= static_cast<float>(probes);
  return {sum[0], sum[1], sum[2]};
}

}  // namespace ydd::sim
