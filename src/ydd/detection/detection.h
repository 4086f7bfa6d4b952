// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "ydd/image/image.h"

namespace ydd {

/// An axis-parallel box in image pixels, [x0, x1) x [y0, y1).
struct Box {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< left, upper, right and lower side

  float width() const { return std::max(0.0F, x1 - x0); }   ///< Never negative.
  float height() const { return std::max(0.0F, y1 - y0); }  ///< Never negative.
  float area() const { return width() * height(); }         ///< In square pixels.
  /// Whether a position lies in it; the right and lower side do not.
  bool contains(float x, float y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  friend bool operator==(const Box&, const Box&) = default;
};

/// What lies in both; without area when they do not meet.
inline Box intersection(const Box& a, const Box& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

/// With every side moved outward by so many pixels.
inline Box grown(const Box& b, float margin_px) {
  return {b.x0 - margin_px, b.y0 - margin_px, b.x1 + margin_px, b.y1 + margin_px};
}

/// One object that a detector saw.
struct Detection {
  std::string class_name;  ///< as in the object catalogue: "person", "head", "chair"
  float score = 1.0F;      ///< confidence in [0, 1]
  Box box;                 ///< inside the image
  GreyImage mask = {};     ///< of the image's size: not 0 where the object is seen; empty: only the
                           ///< box is known
  bool sure = true;        ///< enough to tell somebody that it is there; without, only to leave
                           ///< points out
};

using Detections = std::vector<Detection>;  ///< Of one frame.

}  // namespace ydd
