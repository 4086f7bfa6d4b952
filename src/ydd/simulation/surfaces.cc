// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/surfaces.h"

#include <algorithm>
#include <cmath>

namespace ydd::sim {
namespace {

Vector2 random_point(Random& random, const Canvas& canvas) {
  const float x = random.uniform_f(0.0F, static_cast<float>(canvas.width()));
  const float y = random.uniform_f(0.0F, static_cast<float>(canvas.height()));
  return {x, y};
}

Colour vivid(Random& random) {
  const float hue = random.uniform_f(0.0F, 1.0F);
  const float saturation = random.uniform_f(0.3F, 0.9F);
  return hsv(hue, saturation, random.uniform_f(0.15F, 0.95F));
}

/// Light or dark, whatever stands out against `other`.
Colour contrasting(Random& random, const Colour& other) {
  const Colour colour = vivid(random);
  const bool bright = other.mean() > 0.45F;
  return bright ? Colour(colour * 0.35F) : Colour(0.55F + 0.45F * colour);
}

void paint_board(Random random, Canvas& canvas, int x0, int y0, int length, int width) {
  const float shade = random.uniform_f(0.75F, 1.15F);
  Canvas board(length, width, bgr(0.24F, 0.38F, 0.55F) * shade);
  board.add_octaves(random, 0.4F * static_cast<float>(width), bgr(0.05F, 0.07F, 0.09F), 4, 0.7F,
                    9.0F);
  const int knots = random.integer(0, 3);
  for (int i = 0; i < knots; ++i) {
    const Vector2 at = random_point(random, board);
    const float r = random.uniform_f(0.04F, 0.12F) * static_cast<float>(width);
    board.fill_ellipse(at, {2.6F * r, 1.5F * r}, 0.0F, bgr(0.12F, 0.2F, 0.3F), 0.5F);
    board.fill_ellipse(at, {1.3F * r, r}, 0.0F, bgr(0.05F, 0.1F, 0.16F), 0.9F);
  }
  const Colour joint = bgr(0.06F, 0.1F, 0.15F);
  const auto l = static_cast<float>(length);
  const auto w = static_cast<float>(width);
  board.fill_box(-1.0F, w - 2.0F, l, w, joint);
  board.fill_box(l - 2.0F, -1.0F, l, w, joint);
  canvas.paste(board, x0, y0);
}

void paint_checks(Random& random, Canvas& canvas, float unit) {
  const Colour a = vivid(random);
  const Colour b = contrasting(random, a);
  const auto size = static_cast<float>(canvas.width());
  for (float y = 0; y < size; y += 2.0F * unit) {
    for (float x = 0; x < size; x += 2.0F * unit) {
      // Each square a little different: a shirt that looks the same everywhere matches nowhere.
      const Colour tint = b * random.uniform_f(0.7F, 1.3F);
      canvas.fill_box(x, y, x + unit, y + unit, tint);
      canvas.fill_box(x + unit, y + unit, x + 2 * unit, y + 2 * unit, tint * 0.8F);
      if (random.chance(0.5)) {
        canvas.fill_ellipse({x + 0.5F * unit, y + 0.5F * unit}, {0.25F * unit, 0.25F * unit}, 0.0F,
                            contrasting(random, tint));
      }
      const Colour dash = vivid(random);
      canvas.fill_rectangle({x + 1.5F * unit, y + 0.5F * unit}, {0.18F * unit, 0.3F * unit},
                            random.uniform_f(0.0F, 3.0F), dash);
    }
  }
}

void paint_stripes(Random& random, Canvas& canvas, float unit) {
  const auto size = static_cast<float>(canvas.width());
  for (float y = 0; y < size;) {
    const float thickness = unit * random.uniform_f(0.5F, 1.8F);
    const Colour colour = vivid(random);
    canvas.fill_box(0, y, size, y + thickness, colour);
    for (float x = 0; x < size; x += unit * random.uniform_f(0.8F, 2.5F)) {
      const float half = 0.3F * thickness;
      const Colour patch = contrasting(random, colour);
      canvas.fill_rectangle({x, y + 0.5F * thickness}, {half, half}, random.uniform_f(0.0F, 1.5F),
                            patch);
    }
    y += thickness;
  }
}

void scatter(Random& random, Canvas& canvas, float unit, Cloth kind) {
  const float area = static_cast<float>(canvas.width()) * static_cast<float>(canvas.height());
  const int count = static_cast<int>(1.1F * area / (unit * unit));
  for (int i = 0; i < count; ++i) {
    const Vector2 at = random_point(random, canvas);
    const float angle = random.uniform_f(0.0F, 3.1F);
    const Colour under = canvas.at(static_cast<int>(at.x()) % canvas.width(),
                                   static_cast<int>(at.y()) % canvas.height());
    const Colour colour = contrasting(random, under);
    const float r = unit * random.uniform_f(0.25F, 0.6F);
    if (kind == Cloth::dots) {
      canvas.fill_ellipse(at, {r, r}, 0.0F, colour);
    } else if (kind == Cloth::blocks) {
      canvas.fill_rectangle(at, {r, r * random.uniform_f(0.4F, 1.4F)}, angle, colour);
    } else if (kind == Cloth::letters) {
      canvas.write_text(random, at.x(), at.y(), at.x() + 4.0F * unit, at.y() + 1.3F * unit, unit,
                        colour);
    } else {
      for (int petal = 0; petal < 5; ++petal) {
        const float turn = angle + 1.2566F * static_cast<float>(petal);
        const Vector2 out(std::cos(turn), std::sin(turn));
        canvas.fill_ellipse(at + 0.6F * r * out, {0.55F * r, 0.25F * r}, turn, colour);
      }
      canvas.fill_ellipse(at, {0.25F * r, 0.25F * r}, 0.0F, contrasting(random, colour));
    }
  }
}

}  // namespace

Canvas paint_plaster(Random random, int width, int height, const Colour& base, float contrast) {
  Canvas canvas(width, height, base);
  const auto size = static_cast<float>(height);
  canvas.add_octaves(random, 0.4F * size, grey(0.030F * contrast), 4, 0.6F);
  canvas.add_noise(random, 3.0F, grey(0.012F * contrast));
  canvas.add_noise(random, 1.5F, grey(0.010F * contrast));
  const int scuffs = static_cast<int>(contrast * 0.16F * static_cast<float>(width));
  for (int i = 0; i < scuffs; ++i) {
    const Vector2 at = random_point(random, canvas);
    const float r = std::exp(random.uniform_f(-6.8F, -4.9F)) * size;
    const Colour scuff = base * random.uniform_f(0.55F, 0.85F);
    const float angle = random.uniform_f(0.0F, 3.0F);
    canvas.fill_ellipse(at, {r, r * random.uniform_f(0.3F, 1.0F)}, angle, scuff, 0.7F);
  }
  return canvas;
}

Canvas paint_boards(Random random, int width, int height, float texel_m) {
  Canvas canvas(width, height, grey(0.3F));
  const int board_width = std::max(4, static_cast<int>(0.14F / texel_m));
  for (int y = 0; y < height; y += board_width) {
    int x = -static_cast<int>(random.uniform(0.0, 0.9) / texel_m);
    while (x < width) {
      const int length = static_cast<int>(random.uniform(0.5, 1.3) / texel_m);
      paint_board(random.fork(static_cast<std::uint64_t>(y) * 4096 + (x + 4096)), canvas, x, y,
                  length, board_width);
      x += length;
    }
    random.bits();
  }
  return canvas;
}

Canvas paint_ceiling(Random random, int width, int height, float texel_m) {
  Canvas canvas(width, height, grey(0.86F));
  canvas.add_octaves(random, 200.0F, grey(0.02F), 3);
  const int speckles = width * height / 900;
  for (int i = 0; i < speckles; ++i) {
    const Vector2 at = random_point(random, canvas);
    const float r = random.uniform_f(0.7F, 2.2F);
    canvas.fill_ellipse(at, {r, r}, 0.0F, grey(random.uniform_f(0.45F, 0.7F)));
  }
  const float tile = 0.6F / texel_m;
  const auto w = static_cast<float>(width);
  const auto h = static_cast<float>(height);
  for (float x = 0; x < w; x += tile) canvas.fill_box(x - 2.0F, 0, x + 2.0F, h, grey(0.5F));
  for (float y = 0; y < h; y += tile) canvas.fill_box(0, y - 2.0F, w, y + 2.0F, grey(0.5F));
  return canvas;
}

Canvas paint_rug(Random random, int width, int height, float texel_m) {
  const Colour base = hsv(random.uniform_f(0.0F, 1.0F), 0.6F, 0.4F);
  Canvas canvas(width, height, base);
  const auto w = static_cast<float>(width);
  const auto h = static_cast<float>(height);
  const float unit = 0.06F / texel_m;
  for (int i = 0; i < 3; ++i) {
    const float inset = unit * (0.4F + static_cast<float>(i));
    canvas.fill_box(inset, inset, w - inset, h - inset, vivid(random));
  }
  const float margin = 3.2F * unit;
  for (float y = margin; y + unit < h - margin; y += unit) {
    for (float x = margin; x + unit < w - margin; x += unit) {
      const Vector2 at(x + 0.5F * unit, y + 0.5F * unit);
      const Colour motif = vivid(random) * 0.8F;
      canvas.fill_rectangle(at, {0.45F * unit, 0.45F * unit}, 0.785F * random.uniform_f(0.0F, 1.0F),
                            motif);
      canvas.fill_ellipse(at, {0.2F * unit, 0.2F * unit}, 0.0F, vivid(random));
    }
  }
  canvas.add_noise(random, 1.5F, grey(0.05F));
  return canvas;
}

Canvas paint_wood(Random random, int side, const Colour& base) {
  Canvas canvas(side, side, base);
  canvas.add_octaves(random, 0.05F * static_cast<float>(side), base * 0.14F, 5, 0.75F, 12.0F);
  canvas.add_noise(random, 1.5F, base * 0.05F);
  return canvas;
}

Canvas paint_plain(Random random, int side, const Colour& base, float grain) {
  Canvas canvas(side, side, base);
  canvas.add_octaves(random, 0.2F * static_cast<float>(side), grey(0.3F * grain), 4);
  canvas.add_noise(random, 2.0F, grey(0.5F * grain));
  return canvas;
}

Canvas paint_cloth(Random random, int side, float texel_m, Cloth kind) {
  const float unit = random.uniform_f(0.026F, 0.036F) / texel_m;
  Canvas canvas(side, side, vivid(random));
  if (kind == Cloth::checks) {
    paint_checks(random, canvas, unit);
  } else if (kind == Cloth::stripes) {
    paint_stripes(random, canvas, unit);
  } else {
    canvas.add_octaves(random, 8.0F * unit, grey(0.15F), 2);
    scatter(random, canvas, unit, kind);
  }
  canvas.add_noise(random, 1.5F, grey(0.04F));
  return canvas;
}

Canvas paint_head(Random random, int width, int height, const Colour& skin, const Colour& hair) {
  Canvas canvas(width, height, skin);
  const auto w = static_cast<float>(width);
  const auto h = static_cast<float>(height);
  canvas.add_octaves(random, 0.2F * h, grey(0.03F), 4);
  const auto at = [&](float u, float v) { return Vector2(u * w, v * h); };
  canvas.fill_ellipse(at(0.5F, 0.66F), {0.035F * w, 0.02F * h}, 0.0F, skin * 0.85F);  // nose tip
  canvas.fill_ellipse(at(0.5F, 0.76F), {0.055F * w, 0.016F * h}, 0.0F, bgr(0.25F, 0.25F, 0.6F));
  for (const float side : {-1.0F, 1.0F}) {
    const float u = 0.5F + 0.075F * side;
    canvas.fill_ellipse(at(u, 0.53F), {0.03F * w, 0.018F * h}, 0.0F, grey(0.95F));
    canvas.fill_ellipse(at(u, 0.53F), {0.013F * w, 0.017F * h}, 0.0F, bgr(0.15F, 0.12F, 0.1F));
    canvas.stroke(at(u - 0.035F, 0.485F), at(u + 0.035F, 0.48F), 0.018F * h, hair * 0.8F);
    canvas.fill_ellipse(at(0.5F + 0.25F * side, 0.58F), {0.02F * w, 0.06F * h}, 0.0F, skin * 0.8F);
  }
  // Hair: the crown and all of the back, with strands.
  Canvas locks(width, height, hair);
  locks.add_octaves(random, 0.03F * w, grey(0.10F), 4, 0.8F, 0.3F);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float azimuth = std::abs(static_cast<float>(x) / w - 0.5F);
      const float line =
          0.36F + std::max(0.0F, azimuth - 0.14F) * 3.2F + 0.02F * std::sin(60.0F * azimuth);
      const float v = static_cast<float>(y) / h;
      if (v < std::min(line, 0.86F)) canvas.at(x, y) = locks.at(x, y);
    }
  }
  return canvas;
}

}  // namespace ydd::sim
