// SPDX-License-Identifier: Apache-2.0
#include "ydd/objects/box_carrier.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "ydd/detection/boxes.h"
#include "ydd/objects/object_tracker.h"

namespace ydd {
namespace {

constexpr int kSmallWidth_px = 160;
const cv::Size kWindow(9, 9);
constexpr int kLevels = 2;  // of the pyramid above the small picture
constexpr int kIterations = 10;
constexpr float kDepthBand_m = 0.5F;     // of a body round its nearest surface
constexpr float kLargestGrowth = 0.05F;  // per frame

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A point of a object: pixels of the small picture, depth in metres (0: none).
struct Sample {
  cv::Point2f at_small;
  float depth_m;
};

float depth_at(const DepthImage& depth_m, float x_px, float y_px) {
  const int x = static_cast<int>(std::lround(x_px));
  const int y = static_cast<int>(std::lround(y_px));
  return depth_m.contains(x, y) ? depth_m(x, y) : 0.0F;
}

/// A grid inside the box, away from its sides; only what lies at the nearest surface, if that is
/// known for enough of it.
std::vector<Sample> samples_of(const Box& box, const DepthImage& depth_m, float scale) {
  constexpr int kColumns = 5;
  constexpr int kRows = 7;
  std::vector<Sample> all;
  std::vector<float> depths;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const float x = box.x0 + box.width() * (static_cast<float>(c) + 1.0F) / (kColumns + 1);
      const float y = box.y0 + box.height() * (static_cast<float>(r) + 1.0F) / (kRows + 1);
      all.push_back({{x * scale, y * scale}, depth_at(depth_m, x, y)});
      if (all.back().depth_m > 0) depths.push_back(all.back().depth_m);
    }
  }
  constexpr std::size_t kEnough = 6;
  if (depths.size() < kEnough) return all;
  const auto quarter = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 4);
  std::nth_element(depths.begin(), quarter, depths.end());
  const float near_m = *quarter;
  std::vector<Sample> near;
  for (const Sample& s : all) {
    if (s.depth_m > 0 && std::abs(s.depth_m - near_m) < kDepthBand_m) near.push_back(s);
  }
  return near.size() < kEnough ? all : near;
}

/// A side of the box after a step; on the border it stays when the object moves in.
float moved_side(float side, float to, float border, bool inward_is_up) {
  constexpr float kOnBorder_px = 2.0F;
  if (std::abs(side - border) > kOnBorder_px) return to;
  return inward_is_up ? std::min(to, side) : std::max(to, side);
}

Box moved(const Box& box, float dx, float dy, float growth, float width_px, float height_px) {
  const float cx = (box.x0 + box.x1) / 2 + dx;
  const float cy = (box.y0 + box.y1) / 2 + dy;
  const float w = box.width() * growth / 2;
  const float h = box.height() * growth / 2;
  return {moved_side(box.x0, cx - w, 0, true), moved_side(box.y0, cy - h, 0, true),
          moved_side(box.x1, cx + w, width_px, false),
          moved_side(box.y1, cy + h, height_px, false)};
}

}  // namespace

struct BoxCarrier::Picture {
  std::int64_t index = 0;
  DepthImage depth_m;
  cv::Mat small;
  std::vector<cv::Mat> pyramid;
  float width_px = 0, height_px = 0, scale = 1;
};

void CarryOptions::describe(OptionTable& table) {
  table.add(
      "motion", motion,
      "flow: with the points in them; constant: as fast as between results; none: boxes stay");
  table.add("missed", missed, {0, 100}, "", "a person survives so many results without it");
  table.add("seen", seen, {1, 100}, "", "if so many results had it");
  table.add("overlap", overlap, {0, 1}, "",
            "intersection over union that makes two boxes of a class the same object");
}

BoxCarrier::BoxCarrier(const CarryOptions& options, ObjectCatalogue catalogue)
    : options_(options), catalogue_(std::move(catalogue)) {}
BoxCarrier::~BoxCarrier() = default;
BoxCarrier::BoxCarrier(BoxCarrier&&) noexcept = default;
BoxCarrier& BoxCarrier::operator=(BoxCarrier&&) noexcept = default;

void BoxCarrier::advance(const RgbdFrame& frame) {
  if (!pictures_.empty() && frame.index <= pictures_.back().index) {
    throw std::logic_error("BoxCarrier: frames must come in order");
  }
  Picture picture;
  picture.index = frame.index;
  picture.depth_m = frame.depth_m;
  picture.width_px = static_cast<float>(frame.grey.width());
  picture.height_px = static_cast<float>(frame.grey.height());
  if (options_.motion == BoxMotion::flow && !frame.grey.empty()) {
    picture.scale = std::min(1.0F, kSmallWidth_px / picture.width_px);
    // Read only, but a Mat cannot say so.
    const cv::Mat grey(frame.grey.height(), frame.grey.width(), CV_8UC1,
                       const_cast<std::uint8_t*>(frame.grey.data()));
    cv::resize(grey, picture.small, {}, picture.scale, picture.scale, cv::INTER_AREA);
    cv::buildOpticalFlowPyramid(picture.small, picture.pyramid, kWindow, kLevels);
  }
  if (!pictures_.empty()) move(objects_, pictures_.back(), picture);
  pictures_.push_back(std::move(picture));
  constexpr std::size_t kLongest = 64;  // a detector that never answers must not fill the memory
  if (pictures_.size() > kLongest) pictures_.erase(pictures_.begin());
}

void BoxCarrier::move(std::vector<Carried>& objects, const Picture& from, const Picture& to) const {
  if (options_.motion == BoxMotion::none) return;
  const std::vector<Flow> flows = flows_of(objects, from, to);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Carried& object = objects[i];
    if (flows[i].known) {
      object.dx_px = flows[i].dx_px;
      object.dy_px = flows[i].dy_px;
    }
    object.detection.box = moved(object.detection.box, object.dx_px, object.dy_px, flows[i].growth,
                                 to.width_px, to.height_px);
  }
  std::erase_if(objects, [&](const Carried& t) {
    const Box seen = clipped(t.detection.box, to.width_px, to.height_px);
    return seen.width() < 1 || seen.height() < 1;
  });
}

std::vector<BoxCarrier::Flow> BoxCarrier::flows_of(const std::vector<Carried>& objects,
                                                   const Picture& from, const Picture& to) {
  std::vector<Flow> flows(objects.size());
  if (from.small.empty() || from.small.size() != to.small.size() || objects.empty()) return flows;
  std::vector<Sample> samples;
  std::vector<std::size_t> ends;
  std::vector<cv::Point2f> before, after;
  for (const Carried& object : objects) {
    for (const Sample& s : samples_of(object.detection.box, from.depth_m, from.scale)) {
      samples.push_back(s);
      before.push_back(s.at_small);
      after.emplace_back(s.at_small.x + object.dx_px * from.scale,
                         s.at_small.y + object.dy_px * from.scale);
    }
    ends.push_back(samples.size());
  }
  std::vector<std::uint8_t> found;
  cv::calcOpticalFlowPyrLK(from.pyramid, to.pyramid, before, after, found, cv::noArray(), kWindow,
                           kLevels,
                           {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kIterations, 0.03},
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0, at = 0; i < objects.size(); ++i) {
    std::vector<float> dx, dy, nearer;
    for (; at < ends[i]; ++at) {
      if (found[at] == 0) continue;
      dx.push_back((after[at].x - before[at].x) / from.scale);
      dy.push_back((after[at].y - before[at].y) / from.scale);
      const float z_m = depth_at(to.depth_m, after[at].x / to.scale, after[at].y / to.scale);
      const float z_before_m = samples[at].depth_m;
      if (z_m > 0 && z_before_m > 0 && std::abs(z_m - z_before_m) < kDepthBand_m) {
        nearer.push_back(z_before_m / z_m);
      }
    }
    flows[i] = summary(std::move(dx), std::move(dy), std::move(nearer));
  }
  return flows;
}

/// Medians, of enough points.
BoxCarrier::Flow BoxCarrier::summary(std::vector<float> dx, std::vector<float> dy,
                                     std::vector<float> nearer) {
  constexpr std::size_t kLeast = 3;
  Flow flow;
  flow.known = dx.size() >= kLeast;
  if (flow.known) {
    flow.dx_px = median(std::move(dx));
    flow.dy_px = median(std::move(dy));
  }
  if (nearer.size() >= kLeast) {
    flow.growth = std::clamp(median(std::move(nearer)), 1 - kLargestGrowth, 1 + kLargestGrowth);
  }
  return flow;
}

std::vector<BoxCarrier::Carried> BoxCarrier::carried(const std::vector<Carried>& objects,
                                                     std::size_t from_picture) const {
  std::vector<Carried> out = objects;
  for (std::size_t i = from_picture; i + 1 < pictures_.size(); ++i) {
    move(out, pictures_[i], pictures_[i + 1]);
  }
  return out;
}

std::vector<int> BoxCarrier::known_as(const std::vector<Carried>& fresh,
                                      const std::vector<Carried>& known) const {
  const auto boxes_of = [](const std::vector<Carried>& objects) {
    std::vector<Box> boxes;
    for (const Carried& object : objects) boxes.push_back(object.detection.box);
    return boxes;
  };
  return associate(boxes_of(fresh), boxes_of(known), options_.overlap,
                   [&](std::size_t f, std::size_t k) {
                     return fresh[f].detection.class_name == known[k].detection.class_name;
                   });
}

void BoxCarrier::set_velocities(std::vector<Carried>& fresh, int frames) const {
  const std::vector<int> before = known_as(fresh, last_result_);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (before[i] < 0) continue;
    Carried& object = fresh[i];
    const Box& a = last_result_[static_cast<std::size_t>(before[i])].detection.box;
    const Box& b = object.detection.box;
    object.dx_px = (b.x0 + b.x1 - a.x0 - a.x1) / 2 / static_cast<float>(frames);
    object.dy_px = (b.y0 + b.y1 - a.y0 - a.y1) / 2 / static_cast<float>(frames);
  }
}

void BoxCarrier::take(std::int64_t frame_index, const Detections& found) {
  std::vector<Carried> fresh = received(frame_index, found);
  while (pictures_.size() > 1 && pictures_[1].index <= frame_index) {
    pictures_.erase(pictures_.begin());
  }
  fresh = carried(fresh, 0);
  std::vector<bool> again(objects_.size(), false);
  const std::vector<int> before = known_as(fresh, objects_);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (before[i] < 0) continue;
    const auto known = static_cast<std::size_t>(before[i]);
    again[known] = true;
    fresh[i].seen = objects_[known].seen + 1;
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Carried& missing = objects_[i];
    if (again[i] || !catalogue_.is_person(missing.detection.class_name) ||
        missing.seen < options_.seen || ++missing.missed > options_.missed) {
      continue;
    }
    fresh.push_back(missing);
  }
  objects_ = std::move(fresh);
}

std::vector<BoxCarrier::Carried> BoxCarrier::received(std::int64_t frame_index,
                                                      const Detections& found) {
  std::vector<Carried> fresh;
  for (const Detection& d : found) {
    Carried object;
    object.detection = d;
    object.detection.mask = {};  // a silhouette does not fit a later frame
    fresh.push_back(std::move(object));
  }
  if (last_result_frame_ >= 0 && frame_index > last_result_frame_) {
    set_velocities(fresh, static_cast<int>(frame_index - last_result_frame_));
  }
  last_result_ = fresh;
  last_result_frame_ = frame_index;
  return fresh;
}

Detections BoxCarrier::now() const {
  Detections out;
  for (const Carried& object : objects_) out.push_back(object.detection);
  if (pictures_.empty()) return sorted_by_score(std::move(out));
  return sorted_by_score(
      clipped(std::move(out), pictures_.back().width_px, pictures_.back().height_px));
}

}  // namespace ydd
