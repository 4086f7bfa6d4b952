// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/moved_objects.h"

#include <algorithm>
#include <cmath>

#include "ydd/dynamics/box_geometry.h"

namespace ydd {
namespace {

/// A box in whole pixels, both ends included.
struct PixelBox {
  int x0, y0, x1, y1;
};

PixelBox pixels_of(const Box& box) {
  return {static_cast<int>(std::floor(box.x0)), static_cast<int>(std::floor(box.y0)),
          static_cast<int>(std::ceil(box.x1)) - 1, static_cast<int>(std::ceil(box.y1)) - 1};
}

/// How far a side is pushed that has `room` pixels left before the object's border.
int push(int room_px, const MovedObjectOptions& options) {
  return room_px < options.push_px ? options.short_push_px : options.push_px;
}

void append_column(const DepthImage& depth_m, int x, int y0, int y1, std::vector<float>& readings) {
  for (int y = y0; y <= y1; ++y) {
    const float d = depth_at(depth_m, static_cast<float>(x), static_cast<float>(y));
    if (d > 0.0F) readings.push_back(d);
  }
}

void append_row(const DepthImage& depth_m, int y, int x0, int x1, std::vector<float>& readings) {
  for (int x = x0; x <= x1; ++x) {
    const float d = depth_at(depth_m, static_cast<float>(x), static_cast<float>(y));
    if (d > 0.0F) readings.push_back(d);
  }
}

bool covers(const Box& a, const Box& b) {
  return a.x0 <= b.x0 && a.y0 <= b.y0 && a.x1 >= b.x1 && a.y1 >= b.y1;
}

}  // namespace

std::vector<float> pushed_side_readings(const DepthImage& depth_m, const Box& hand,
                                        const Box& object, const MovedObjectOptions& options) {
  std::vector<float> readings;
  const PixelBox c = pixels_of(intersection(hand, object));
  const PixelBox o = pixels_of(object);
  if (c.x0 > c.x1 || c.y0 > c.y1) return readings;
  if (c.x0 > o.x0) append_column(depth_m, c.x0 - push(c.x0 - o.x0, options), c.y0, c.y1, readings);
  if (c.x1 < o.x1) append_column(depth_m, c.x1 + push(o.x1 - c.x1, options), c.y0, c.y1, readings);
  if (c.y0 > o.y0) append_row(depth_m, c.y0 - push(c.y0 - o.y0, options), c.x0, c.x1, readings);
  if (c.y1 < o.y1) append_row(depth_m, c.y1 + push(o.y1 - c.y1, options), c.x0, c.x1, readings);
  return readings;
}

bool moved_by_hand(const DepthImage& depth_m, const SceneObject& hand, const SceneObject& object,
                   double front_allowance, const MovedObjectOptions& options) {
  if (!hand.depth_m || !object.depth_m || disjoint(hand.box, object.box)) return false;
  const DepthRange object_depths = object_range(*object.depth_m, object.extent_m, front_allowance);
  if (!object_depths.contains(*hand.depth_m)) return false;
  if (covers(hand.box, object.box)) return true;
  const DepthRange hand_depths = object_range(*hand.depth_m, hand.extent_m, front_allowance);
  const std::vector<float> readings = pushed_side_readings(depth_m, hand.box, object.box, options);
  const auto touching = std::count_if(readings.begin(), readings.end(),
                                      [&](float d) { return hand_depths.contains(d); });
  return touching >= options.contact_readings;
}

bool may_move_with(std::span<const SceneObject> objects, const Body& body,
                   const SceneObject& object, int hands) {
  const auto seen = std::count_if(body.hands.begin(), body.hands.end(),
                                  [&](int i) { return objects[i].depth_m.has_value(); });
  return seen < hands && intersect(objects[body.person].box, object.box);
}

bool moved_near_body(std::span<const SceneObject> objects, const Body& body,
                     const DepthRange& body_range, const SceneObject& object, int hands) {
  return may_move_with(objects, body, object, hands) && object.depth_m &&
         body_range.contains(*object.depth_m);
}

}  // namespace ydd
