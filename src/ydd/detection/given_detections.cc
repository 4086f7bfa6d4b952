// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/given_detections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "ydd/detection/boxes.h"
#include "ydd/detection/person_check.h"

namespace ydd {
namespace {

std::string text_of(const Box& b) {
  return fmt::format("[{}, {}, {}, {}]", b.x0, b.y0, b.x1, b.y1);
}

/// Why a detection cannot be used; empty: it can.
std::string complaint(const Detection& d, int width_px, int height_px) {
  if (d.class_name.empty()) return "has no class";
  if (!(d.score >= 0.0F && d.score <= 1.0F)) {
    return fmt::format("has the score {}, which must be in [0, 1]", d.score);
  }
  if (!d.mask.empty()) {
    if (d.mask.width() == width_px && d.mask.height() == height_px) return "";
    return fmt::format("has a mask of {} x {}, but the picture has {} x {}", d.mask.width(),
                       d.mask.height(), width_px, height_px);
  }
  const Box& b = d.box;
  const bool finite =
      std::isfinite(b.x0) && std::isfinite(b.y0) && std::isfinite(b.x1) && std::isfinite(b.y1);
  if (!finite || b.x1 < b.x0 || b.y1 < b.y0) {
    return "has the box " + text_of(b) + ", which must be [x0, y0, x1, y1] with x0 <= x1, y0 <= y1";
  }
  if (reaches_far_beyond(b, static_cast<float>(width_px), static_cast<float>(height_px))) {
    return fmt::format("has the box {}, far beyond the picture of {} x {}", text_of(b), width_px,
                       height_px);
  }
  return "";
}

/// Whether all boxes are fractions of the picture, as trainers write them.
bool are_fractions(const Detections& given) {
  const auto is_box = [](const Detection& d) { return d.mask.empty(); };
  const auto in_pixels = [&](const Detection& d) {
    return is_box(d) && !lies_in_first_pixel(d.box);
  };
  const auto partial = [&](const Detection& d) { return is_box(d) && !has_whole_sides(d.box); };
  return std::none_of(given.begin(), given.end(), in_pixels) &&
         std::any_of(given.begin(), given.end(), partial);
}

}  // namespace

std::optional<Box> box_round(const GreyImage& mask) {
  int x0 = mask.width(), y0 = mask.height(), x1 = 0, y1 = 0;
  for (int y = 0; y < mask.height(); ++y) {
    const std::uint8_t* const row = mask.row(y);
    for (int x = 0; x < mask.width(); ++x) {
      if (row[x] == 0) continue;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x + 1);
      y0 = std::min(y0, y);
      y1 = y + 1;
    }
  }
  if (x1 <= x0) return std::nullopt;
  return Box{static_cast<float>(x0), static_cast<float>(y0), static_cast<float>(x1),
             static_cast<float>(y1)};
}

Result<Detections> given_detections(Detections given, const ObjectCatalogue& catalogue,
                                    int width_px, int height_px, const std::string& source) {
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string wrong = complaint(given[i], width_px, height_px);
    if (wrong.empty()) continue;
    return Error{fmt::format("{}: detection {} ('{}') {}", source, i, given[i].class_name, wrong)};
  }
  if (are_fractions(given)) {
    return Error{source +
                 ": all boxes lie between 0 and 1: fractions of the picture; give pixels (x times "
                 "its width, y times its height)"};
  }
  Detections out;
  for (Detection& d : given) {
    if (!d.mask.empty()) {
      const std::optional<Box> box = box_round(d.mask);
      if (!box) continue;
      d.box = *box;
    }
    d.class_name = name_in_rules(d.class_name, catalogue);
    out.push_back(std::move(d));
  }
  return sorted_by_score(
      clipped(std::move(out), static_cast<float>(width_px), static_cast<float>(height_px)));
}

}  // namespace ydd
