// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/pictures.h"

#include <algorithm>
#include <cmath>

namespace ydd::sim {
namespace {

struct Size {
  explicit Size(const Canvas& canvas)
      : w(static_cast<float>(canvas.width())),
        h(static_cast<float>(canvas.height())),
        side(std::min(w, h)) {}
  float w;
  float h;
  float side;
};

Colour any_colour(Random& random) {
  const float hue = random.uniform_f(0.0F, 1.0F);
  const float saturation = random.uniform_f(0.15F, 0.85F);
  return hsv(hue, saturation, random.uniform_f(0.1F, 0.95F));
}

Vector2 point_in(Random& random, float x0, float y0, float x1, float y1) {
  const float x = random.uniform_f(x0, x1);
  return {x, random.uniform_f(y0, y1)};
}

/// Sky, layered hills, houses and trees: irregular structure on all scales, like a photograph.
void photo(Random& random, Canvas& canvas) {
  const Size s(canvas);
  const Colour sky = hsv(random.uniform_f(0.5F, 0.65F), 0.45F, 0.9F);
  canvas.fill_box(-1, -1, s.w, s.h, sky);
  canvas.add_octaves(random, 0.35F * s.side, grey(0.16F), 6, 0.6F, 1.6F);
  float horizon = random.uniform_f(0.25F, 0.45F) * s.h;
  for (int layer = 0; layer < 4; ++layer) {
    const Colour ground = any_colour(random) * (0.9F - 0.15F * static_cast<float>(layer));
    float top = horizon;
    const float step = s.w / 60.0F;
    for (float x = 0; x < s.w; x += step) {
      top += random.uniform_f(-1.0F, 1.0F) * 0.02F * s.h;
      canvas.fill_box(x, top, x + step, s.h, ground);
      if (random.chance(0.3)) {
        const float r = random.uniform_f(0.01F, 0.05F) * s.side;
        canvas.fill_ellipse({x, top}, {r, 1.4F * r}, 0.0F, ground * random.uniform_f(0.4F, 1.4F));
      }
    }
    for (int i = 0; i < 7; ++i) {
      const Vector2 at = point_in(random, 0, horizon, s.w, s.h);
      const float half = random.uniform_f(0.015F, 0.06F) * s.side;
      const Colour wall = any_colour(random);
      canvas.fill_rectangle(at, {half, 1.3F * half}, 0.0F, wall);
      canvas.fill_rectangle(at - Vector2(0, 1.6F * half), {0.8F * half, 0.5F * half}, 0.785F,
                            wall * 0.5F);
      canvas.fill_rectangle(at, {0.3F * half, 0.3F * half}, 0.0F, wall * 0.2F);
    }
    horizon += random.uniform_f(0.1F, 0.2F) * s.h;
  }
  canvas.add_octaves(random, 0.05F * s.side, grey(0.09F), 5, 0.8F);
}

void sheet(Random& random, Canvas& canvas) {
  const Size s(canvas);
  canvas.fill_box(-1, -1, s.w, s.h, grey(random.uniform_f(0.85F, 0.97F)));
  const Colour ink = any_colour(random) * 0.4F;
  const float margin = 0.07F * s.w;
  const float title = 0.06F * s.side;
  canvas.write_text(random, margin, margin, s.w - margin, margin + 1.8F * title, title, ink);
  float y = margin + 2.6F * title;
  while (y < s.h - margin) {
    const float height = random.uniform_f(0.12F, 0.25F) * s.h;
    const float split = random.uniform_f(0.35F, 0.65F) * s.w;
    const float letter = random.uniform_f(0.018F, 0.032F) * s.side;
    const float bottom = std::min(y + height, s.h - margin);
    canvas.write_text(random, margin, y, split - margin, bottom, letter, grey(0.1F));
    if (random.chance(0.6)) {
      Canvas inset(static_cast<int>(s.w - split - margin), static_cast<int>(bottom - y),
                   grey(0.5F));
      photo(random, inset);
      canvas.paste(inset, static_cast<int>(split), static_cast<int>(y));
    } else {
      canvas.write_text(random, split, y, s.w - margin, bottom, letter, grey(0.1F));
    }
    y += height + 0.04F * s.h;
  }
}

void chart(Random& random, Canvas& canvas) {
  const Size s(canvas);
  canvas.fill_box(-1, -1, s.w, s.h, grey(0.93F));
  for (int row = 0; row < 2; ++row) {
    const float top = (0.12F + 0.45F * static_cast<float>(row)) * s.h;
    const float base = top + 0.36F * s.h;
    const float width = 0.8F * s.w / 12.0F;
    const Colour colour = any_colour(random);
    for (int i = 0; i < 12; ++i) {
      const float x = 0.1F * s.w + width * static_cast<float>(i);
      const float height = random.uniform_f(0.03F, 0.32F) * s.h;
      canvas.fill_box(x, base - height, x + 0.7F * width, base,
                      random.chance(0.3) ? any_colour(random) : colour);
      const float letter = 0.02F * s.side;
      canvas.write_text(random, x, base + letter, x + width, base + 2.2F * letter, letter,
                        grey(0.1F));
    }
    canvas.stroke({0.08F * s.w, top}, {0.08F * s.w, base}, 3.0F, grey(0.1F));
    canvas.stroke({0.08F * s.w, base}, {0.94F * s.w, base}, 3.0F, grey(0.1F));
  }
  canvas.write_text(random, 0.08F * s.w, 0.03F * s.h, 0.9F * s.w, 0.11F * s.h, 0.05F * s.side,
                    grey(0.1F));
}

void street_map(Random& random, Canvas& canvas) {
  const Size s(canvas);
  canvas.fill_box(-1, -1, s.w, s.h, bgr(0.75F, 0.88F, 0.86F));
  canvas.add_octaves(random, 0.3F * s.side, bgr(0.10F, 0.03F, 0.12F), 3);
  for (int i = 0; i < 70; ++i) {
    const Vector2 at = point_in(random, 0, 0, s.w, s.h);
    const Vector2 half = point_in(random, 0.01F, 0.01F, 0.05F, 0.05F) * s.side;
    const Colour block = any_colour(random);
    canvas.fill_rectangle(at, half, random.uniform_f(0.0F, 1.5F), block, 0.9F);
  }
  for (int i = 0; i < 26; ++i) {
    Vector2 from = point_in(random, 0, 0, s.w, s.h);
    const float width = random.uniform_f(0.004F, 0.018F) * s.side;
    const Colour colour = random.chance(0.5) ? grey(1.0F) : bgr(0.2F, 0.5F, 0.95F);
    for (int leg = 0; leg < 5; ++leg) {
      const Vector2 to = from + point_in(random, -0.2F, -0.2F, 0.2F, 0.2F) * s.side;
      canvas.stroke(from, to, width + 2.0F, grey(0.35F));
      canvas.stroke(from, to, width, colour);
      from = to;
    }
  }
  for (int i = 0; i < 25; ++i) {
    const Vector2 at = point_in(random, 0, 0, s.w, s.h);
    const float letter = random.uniform_f(0.018F, 0.035F) * s.side;
    canvas.write_text(random, at.x(), at.y(), at.x() + 8.0F * letter, at.y() + 1.2F * letter,
                      letter, grey(0.05F));
  }
}

void mosaic(Random& random, Canvas& canvas, float x0, float y0, float x1, float y1, int depth) {
  const float w = x1 - x0;
  const float h = y1 - y0;
  if (depth == 0 || (depth < 4 && random.chance(0.12))) {
    canvas.fill_box(x0, y0, x1, y1, any_colour(random));
    const Vector2 centre(0.5F * (x0 + x1), 0.5F * (y0 + y1));
    if (random.chance(0.5)) {
      canvas.fill_ellipse(centre, {0.35F * w, 0.35F * h}, 0.0F, any_colour(random));
    }
    return;
  }
  const float cut = random.uniform_f(0.3F, 0.7F);
  if (w > h) {
    mosaic(random, canvas, x0, y0, x0 + cut * w, y1, depth - 1);
    mosaic(random, canvas, x0 + cut * w, y0, x1, y1, depth - 1);
  } else {
    mosaic(random, canvas, x0, y0, x1, y0 + cut * h, depth - 1);
    mosaic(random, canvas, x0, y0 + cut * h, x1, y1, depth - 1);
  }
}

void shapes(Random& random, Canvas& canvas) {
  const Size s(canvas);
  canvas.fill_box(-1, -1, s.w, s.h, any_colour(random));
  for (int i = 0; i < 90; ++i) {
    const Vector2 at = point_in(random, 0, 0, s.w, s.h);
    const float scale = std::exp(random.uniform_f(-4.4F, -2.0F)) * s.side;
    const float angle = random.uniform_f(0.0F, 3.1F);
    const Colour colour = any_colour(random);
    switch (random.integer(0, 2)) {
      case 0:
        canvas.fill_ellipse(at, {scale, scale * random.uniform_f(0.4F, 1.0F)}, angle, colour);
        break;
      case 1:
        canvas.fill_rectangle(at, {scale, scale * random.uniform_f(0.2F, 1.0F)}, angle, colour);
        break;
      default:
        canvas.stroke(at, at + 3.0F * scale * Vector2(std::cos(angle), std::sin(angle)),
                      0.3F * scale, colour);
    }
  }
}

void note(Random& random, Canvas& canvas, const Vector2& at, float width, float height) {
  Canvas paper(static_cast<int>(width), static_cast<int>(height), grey(0.9F));
  if (random.chance(0.4)) {
    paper.fill_box(-1, -1, width, height, hsv(random.uniform_f(0.1F, 0.2F), 0.6F, 0.95F));
    paper.write_text(random, 0.1F * width, 0.1F * height, 0.9F * width, 0.9F * height,
                     0.12F * width, any_colour(random) * 0.4F);
  } else {
    paper = paint_poster(random.fork(7), paper.width(), paper.height());
  }
  paper.fill_ellipse({0.5F * width, 0.05F * height}, {0.04F * width, 0.04F * width}, 0.0F,
                     bgr(0.1F, 0.1F, 0.8F));
  canvas.paste(paper, static_cast<int>(at.x()), static_cast<int>(at.y()));
}

}  // namespace

Canvas paint_poster(Random random, int width, int height) {
  Canvas canvas(width, height, grey(0.9F));
  const Size s(canvas);
  switch (random.integer(0, 6)) {
    case 0:
    case 1:
      photo(random, canvas);
      break;
    case 2:
      sheet(random, canvas);
      break;
    case 3:
      chart(random, canvas);
      break;
    case 4:
      street_map(random, canvas);
      break;
    case 5:
      mosaic(random, canvas, 0, 0, s.w, s.h, 8);
      break;
    default:
      shapes(random, canvas);
  }
  const float rim = 0.012F * s.side;
  const Colour frame = grey(random.uniform_f(0.05F, 0.95F));
  canvas.fill_box(-1, -1, s.w, rim, frame);
  canvas.fill_box(-1, s.h - rim, s.w, s.h, frame);
  canvas.fill_box(-1, -1, rim, s.h, frame);
  canvas.fill_box(s.w - rim, -1, s.w, s.h, frame);
  return canvas;
}

Canvas paint_screen(Random random, int width, int height) {
  Canvas canvas(width, height, grey(0.2F));
  const Size s(canvas);
  photo(random, canvas);
  for (int i = 0; i < 3; ++i) {
    const Vector2 low = point_in(random, 0.02F * s.w, 0.02F * s.h, 0.45F * s.w, 0.4F * s.h);
    const Vector2 high = low + point_in(random, 0.3F * s.w, 0.3F * s.h, 0.55F * s.w, 0.55F * s.h);
    const bool dark = random.chance(0.5);
    canvas.fill_box(low.x(), low.y(), high.x(), high.y(), grey(dark ? 0.12F : 0.94F));
    const float bar = 0.04F * s.h;
    canvas.fill_box(low.x(), low.y(), high.x(), low.y() + bar, any_colour(random));
    for (float y = low.y() + 1.5F * bar; y + bar < high.y(); y += bar) {
      const float indent = random.uniform_f(0.01F, 0.12F) * s.w;
      const Colour ink =
          dark ? Colour(0.5F + 0.5F * any_colour(random)) : any_colour(random) * 0.5F;
      const float end = random.uniform_f(low.x() + indent, high.x());
      canvas.write_text(random, low.x() + indent, y, end, y + bar, 0.6F * bar, ink);
    }
  }
  canvas.fill_box(-1, 0.96F * s.h, s.w, s.h, grey(0.15F));
  for (int i = 0; i < 8; ++i) {
    const float x = (0.02F + 0.03F * static_cast<float>(i)) * s.w;
    canvas.fill_box(x, 0.965F * s.h, x + 0.02F * s.w, 0.995F * s.h, any_colour(random));
  }
  return canvas;
}

Canvas paint_keyboard(Random random, int width, int height) {
  Canvas canvas(width, height, grey(0.12F));
  const Size s(canvas);
  const float pitch = s.h / 6.0F;
  for (int row = 0; row < 5; ++row) {
    const float y = (0.5F + static_cast<float>(row)) * pitch;
    for (float x = 0.5F * pitch; x < s.w - pitch;) {
      const float key = pitch * (random.chance(0.12) ? 1.8F : 1.0F);
      canvas.fill_box(x + 1, y + 1, x + key - 1, y + pitch - 1,
                      grey(random.uniform_f(0.24F, 0.3F)));
      canvas.write_text(random, x + 0.3F * pitch, y + 0.25F * pitch, x + 0.8F * pitch,
                        y + 0.8F * pitch, 0.45F * pitch, grey(0.85F));
      x += key;
    }
  }
  return canvas;
}

Canvas paint_spine(Random random, int width, int height) {
  const Colour base = any_colour(random);
  Canvas canvas(width, height, base);
  const Size s(canvas);
  const Colour ink = base.mean() > 0.45F ? grey(0.08F) : bgr(0.6F, 0.9F, 0.95F);
  const int bands = random.integer(1, 3);
  for (int i = 0; i < bands; ++i) {
    const float y = random.uniform_f(0.02F, 0.9F) * s.h;
    const Colour band = any_colour(random);
    canvas.fill_box(-1, y, s.w, y + random.uniform_f(0.01F, 0.08F) * s.h, band);
  }
  canvas.write_text(random, 0.15F * s.w, 0.15F * s.h, 0.9F * s.w, 0.8F * s.h, 0.4F * s.w, ink);
  canvas.add_noise(random, 2.0F, grey(0.02F));
  return canvas;
}

Canvas paint_cover(Random random, int width, int height) {
  Canvas canvas = paint_poster(random.fork(1), width, height);
  const Size s(canvas);
  const Colour band = any_colour(random);
  canvas.fill_box(-1, 0.08F * s.h, s.w, 0.3F * s.h, band);
  canvas.write_text(random, 0.08F * s.w, 0.1F * s.h, 0.92F * s.w, 0.29F * s.h, 0.09F * s.w,
                    band.mean() > 0.45F ? grey(0.05F) : grey(0.95F));
  return canvas;
}

Canvas paint_whiteboard(Random random, int width, int height) {
  Canvas canvas(width, height, grey(0.92F));
  const Size s(canvas);
  canvas.add_octaves(random, 0.3F * s.h, grey(0.02F), 3);
  const std::array<Colour, 4> pens = {grey(0.1F), bgr(0.7F, 0.2F, 0.1F), bgr(0.1F, 0.1F, 0.75F),
                                      bgr(0.15F, 0.5F, 0.1F)};
  for (int i = 0; i < 26; ++i) {
    const Colour& pen = pens[random.integer(0, 3)];
    const Vector2 at = point_in(random, 0.03F * s.w, 0.05F * s.h, 0.85F * s.w, 0.85F * s.h);
    const float letter = random.uniform_f(0.016F, 0.036F) * s.h;
    if (random.chance(0.5)) {
      canvas.write_text(random, at.x(), at.y(), at.x() + 9.0F * letter, at.y() + 5.0F * letter,
                        letter, pen);
      continue;
    }
    Vector2 from = at;
    for (int node = 0; node < 4; ++node) {
      const Vector2 half(1.6F * letter, 0.9F * letter);
      canvas.fill_rectangle(from, half, 0.0F, pen);
      canvas.fill_rectangle(from, half - Vector2(3, 3), 0.0F, grey(0.92F));
      canvas.write_text(random, from.x() - letter, from.y() - 0.3F * letter, from.x() + letter,
                        from.y() + 0.6F * letter, 0.6F * letter, pen);
      const Vector2 to = from + point_in(random, 1.0F, -2.0F, 4.5F, 3.0F) * letter;
      canvas.stroke(from + Vector2(half.x(), 0), to, 3.0F, pen);
      from = to;
    }
  }
  return canvas;
}

Canvas paint_pinboard(Random random, int width, int height) {
  Canvas canvas(width, height, bgr(0.28F, 0.45F, 0.62F));
  const Size s(canvas);
  canvas.add_octaves(random, 6.0F, grey(0.12F), 3);
  for (int i = 0; i < 22; ++i) {
    const float w = random.uniform_f(0.08F, 0.2F) * s.w;
    const float h = w * random.uniform_f(0.8F, 1.4F);
    const Vector2 at = point_in(random, 0.0F, 0.0F, s.w - w, std::max(1.0F, s.h - h));
    note(random, canvas, at, w, h);
    random.bits();
  }
  return canvas;
}

Canvas paint_mug(Random random, int width, int height) {
  const Colour base = any_colour(random);
  Canvas canvas(width, height, base);
  const Size s(canvas);
  const Colour ink = base.mean() > 0.45F ? grey(0.1F) : grey(0.95F);
  canvas.fill_box(-1, 0.1F * s.h, s.w, 0.16F * s.h, ink);
  canvas.fill_box(-1, 0.84F * s.h, s.w, 0.9F * s.h, ink);
  for (int i = 0; i < 5; ++i) {
    const Vector2 at((0.1F + 0.2F * static_cast<float>(i)) * s.w, 0.5F * s.h);
    const float r = 0.22F * s.h;
    canvas.fill_ellipse(at, {r, r}, 0.0F, any_colour(random));
    canvas.fill_rectangle(at, {0.5F * r, 0.5F * r}, random.uniform_f(0.0F, 1.5F), ink);
  }
  return canvas;
}

Canvas paint_window(Random random, int width, int height) {
  Canvas canvas(width, height, grey(0.9F));
  const Size s(canvas);
  photo(random, canvas);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) canvas.at(x, y) = 0.25F + 0.75F * canvas.at(x, y);
  }
  const float bar = 0.03F * s.side;
  const Colour frame = grey(0.85F);
  for (const float x : {0.0F, 0.5F * s.w, s.w}) canvas.fill_box(x - bar, -1, x + bar, s.h, frame);
  for (const float y : {0.0F, 0.65F * s.h, s.h}) canvas.fill_box(-1, y - bar, s.w, y + bar, frame);
  return canvas;
}

Canvas paint_door(Random random, int width, int height) {
  const Colour base = bgr(0.2F, 0.33F, 0.48F);
  Canvas canvas(width, height, base);
  const Size s(canvas);
  canvas.add_octaves(random, 0.06F * s.h, base * 0.15F, 5, 0.75F, 0.15F);
  for (const float y : {0.27F, 0.74F}) {
    const Vector2 centre(0.5F * s.w, y * s.h);
    const Vector2 half(0.34F * s.w, 0.18F * s.h);
    canvas.fill_rectangle(centre, half, 0.0F, base * 0.6F, 0.8F);
    canvas.fill_rectangle(centre, half - Vector2(6, 6), 0.0F, base * 1.1F, 0.6F);
  }
  canvas.fill_ellipse({0.9F * s.w, 0.5F * s.h}, {0.03F * s.w, 0.03F * s.w}, 0.0F, grey(0.8F));
  return canvas;
}

}  // namespace ydd::sim
