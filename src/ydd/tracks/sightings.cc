// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracks/sightings.h"

#include <algorithm>
#include <cmath>

#include "ydd/detection/boxes.h"

namespace ydd {
namespace {

constexpr float kBody_m = 0.4F;         // readings so far from the middle one are of something else
constexpr double kBodyHalf_m = 0.11;    // from the surface of a person to its middle, mean of all
constexpr double kSurfaceShare = 0.25;  // the same of other things, of their extent
constexpr std::size_t kLeastReadings = 12;
constexpr float kBorder_px = 2;
constexpr double kCutFactor = 3;  // of the error, along the axis in which a thing is cut

/// A reading as a point of the camera frame.
struct Reading {
  float x_px = 0, y_px = 0, z_m = 0;
};

/// The value below which a share of all lies. Keeps its memory between calls.
class Quantile {
 public:
  template <class Items, class Get>
  float operator()(const Items& items, double share, Get get) {
    values_.clear();
    values_.reserve(items.size());
    for (const auto& item : items) values_.push_back(get(item));
    const auto k =
        static_cast<std::ptrdiff_t>(share * static_cast<double>(values_.size() - 1) + 0.5);
    std::nth_element(values_.begin(), values_.begin() + k, values_.end());
    return values_[static_cast<std::size_t>(k)];
  }

 private:
  std::vector<float> values_;
};

/// The readings of a frame on a coarse grid; each is given to one object only.
class Readings {
 public:
  explicit Readings(const DepthImage& depth_m)
      : depth_m_(depth_m),
        step_px_(std::max(1, depth_m.width() / 160)),
        columns_((depth_m.width() + step_px_ - 1) / step_px_),
        taken_(static_cast<std::size_t>(columns_) *
               static_cast<std::size_t>((depth_m.height() + step_px_ - 1) / step_px_)) {}

  /// Those in the box and the range that no object has taken.
  std::vector<Reading> in(const Box& box, const DepthRange& range) const {
    std::vector<Reading> out;
    out.reserve(
        static_cast<std::size_t>(box.area()) / static_cast<std::size_t>(step_px_ * step_px_) + 1);
    visit(box, [&](int x, int y, float z_m) {
      const bool free = taken_[index(x, y)] == 0;
      if (free && range.contains(z_m)) {
        out.push_back({static_cast<float>(x), static_cast<float>(y), z_m});
      }
    });
    return out;
  }
  void take(const std::vector<Reading>& readings) {
    for (const Reading& r : readings) {
      taken_[index(static_cast<int>(r.x_px), static_cast<int>(r.y_px))] = 1;
    }
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y / step_px_) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x / step_px_);
  }
  template <class Visit>
  void visit(const Box& box, Visit&& visit) const {
    const auto first = [&](float px) { return (static_cast<int>(px) / step_px_) * step_px_; };
    for (int y = std::max(0, first(box.y0)); y < depth_m_.height(); y += step_px_) {
      if (static_cast<float>(y) >= box.y1) break;
      for (int x = std::max(0, first(box.x0)); x < depth_m_.width(); x += step_px_) {
        if (static_cast<float>(x) >= box.x1) break;
        visit(x, y, depth_m_(x, y));
      }
    }
  }

  DepthImage depth_m_;
  int step_px_;
  int columns_;
  std::vector<std::uint8_t> taken_;
};

/// The part of a person's box that its trunk fills; of others the middle of the box.
Box core_of(const Box& box, bool person) {
  const float side = 0.25F * box.width();
  const float top = person ? 0.1F : 0.2F;
  const float bottom = person ? 0.65F : 0.8F;
  return {box.x0 + side, box.y0 + top * box.height(), box.x1 - side,
          box.y0 + bottom * box.height()};
}

/// What is asked about one object.
struct Asked {
  const ObjectJudgement* object = nullptr;
  bool person = false;
  double thickness_m = 0;  ///< along the line of sight
  DepthRange range;
};

/// Its readings: around the middle one of those in its core, and around the thing's own thickness.
std::vector<Reading> readings_of(const Asked& asked, const Readings& all, Quantile& quantile) {
  const Box& box = asked.object->box;
  std::vector<Reading> core = all.in(core_of(box, asked.person), asked.range);
  if (core.size() < kLeastReadings) core = all.in(box, asked.range);
  if (core.size() < kLeastReadings) return {};
  const float middle_m = quantile(core, 0.5, [](const Reading& r) { return r.z_m; });
  const float reach_m =
      asked.person ? kBody_m : std::max(0.1F, static_cast<float>(asked.thickness_m));
  return all.in(box, {middle_m - reach_m, middle_m + reach_m});
}

class Measure {
 public:
  Measure(const Camera& camera, const SensorNoise& noise, const WorldTrackOptions& options)
      : camera_(camera), noise_(noise), options_(options) {}

  /// `half_m`: from the surface that is seen to the middle.
  Sighting of(const std::vector<Reading>& readings, const Box& box, double half_m,
              double thickness_m, Quantile& quantile) const {
    const auto axis = [&](int k) {
      return [this, k](const Reading& r) {
        return k == 0 ? (r.x_px - static_cast<float>(camera_.cx_px)) * r.z_m /
                            static_cast<float>(camera_.fx_px)
               : k == 1 ? (r.y_px - static_cast<float>(camera_.cy_px)) * r.z_m /
                              static_cast<float>(camera_.fy_px)
                        : r.z_m;
      };
    };
    Sighting out;
    const double z_m = static_cast<double>(quantile(readings, 0.5, axis(2)));
    const Eigen::Vector2d image_px(
        static_cast<double>(quantile(readings, 0.5, [](const Reading& r) { return r.x_px; })),
        static_cast<double>(quantile(readings, 0.5, [](const Reading& r) { return r.y_px; })));
    const Eigen::Vector3d surface = camera_.unproject(camera_.undistort(image_px), z_m);
    out.p_camera = surface * (1.0 + half_m / surface.norm());
    for (int k = 0; k < 2; ++k) {
      out.extent_m[k] = static_cast<double>(quantile(readings, 0.98, axis(k)) -
                                            quantile(readings, 0.02, axis(k)));
    }
    out.extent_m.z() = thickness_m;
    const bool cut_x = box.x0 < kBorder_px || box.x1 > image_width() - kBorder_px;
    const bool cut_y = box.y0 < kBorder_px || box.y1 > image_height() - kBorder_px;
    out.cut = cut_x || cut_y;
    out.covariance_m2 = covariance(out, cut_x, cut_y);
    return out;
  }

 private:
  float image_width() const { return static_cast<float>(camera_.width_px); }
  float image_height() const { return static_cast<float>(camera_.height_px); }

  /// The sensor's noise, and how far the middle of what is seen is from the middle of the thing.
  Eigen::Matrix3d covariance(const Sighting& s, bool cut_x, bool cut_y) const {
    const double sensor_m = static_cast<double>(noise_.sigma_m(static_cast<float>(s.p_camera.z())));
    Eigen::Vector3d sigma_m = options_.shape_share * s.extent_m;
    if (cut_x) sigma_m.x() *= kCutFactor;
    if (cut_y) sigma_m.y() *= kCutFactor;
    const Eigen::Vector3d along = s.p_camera / s.p_camera.z();  // a reading's error, on its ray
    Eigen::Matrix3d out = sensor_m * sensor_m * along * along.transpose();
    out.diagonal() += sigma_m.cwiseAbs2() + Eigen::Vector3d::Constant(1e-4);
    return out;
  }

  const Camera& camera_;
  const SensorNoise& noise_;
  const WorldTrackOptions& options_;
};

/// Whether an object is told of: persons always, other things when they were judged to move.
bool is_followed(const ObjectJudgement& object) {
  switch (object.subcategory) {
    case Subcategory::person:
      return true;
    case Subcategory::head:
    case Subcategory::hand:
    case Subcategory::stationary:
      return false;
    case Subcategory::automatic:
    case Subcategory::small:
    case Subcategory::medium:
    case Subcategory::large:
      return object.rule != Rule::kept;
  }
  return false;
}

/// The depth of the head that was matched to a person; none: no head, or no reading on it.
std::optional<float> head_depth(const ObjectJudgement& person, const Judgement& judgement) {
  for (const ObjectJudgement& object : judgement.objects) {
    if (person.head >= 0 && object.detection == person.head) return object.depth_m;
  }
  return std::nullopt;
}

/// Where a person's readings are to be looked for; none: others hide too much of it to tell.
std::optional<DepthRange> body_readings(const ObjectJudgement& person, const Judgement& judgement) {
  constexpr float kHidden = 0.3F;  // share of the box that another person's box covers
  constexpr float kHeadReach_m = 0.45F;
  if (const auto head_m = head_depth(person, judgement)) {
    return DepthRange{*head_m - kHeadReach_m, *head_m + kHeadReach_m};
  }
  if (person.coincidence > kHidden || !person.depth_m) return std::nullopt;
  return DepthRange{*person.depth_m - 0.2F, *person.depth_m + 1.0F};
}

/// The objects to measure, the nearest first.
std::vector<Asked> asked_of(const SightedFrame& frame, const ObjectCatalogue& catalogue) {
  std::vector<Asked> out;
  for (const ObjectJudgement& object : frame.judgement.objects) {
    if (!is_followed(object)) continue;
    Asked asked{&object, object.subcategory == Subcategory::person, 0, {}};
    const double extent_m =
        catalogue.extent_m(frame.detections[static_cast<std::size_t>(object.detection)].class_name);
    asked.thickness_m = asked.person ? 2 * kBodyHalf_m : extent_m;
    std::optional<DepthRange> range;
    if (asked.person) {
      range = body_readings(object, frame.judgement);
    } else if (object.depth_m) {
      const auto reach_m = static_cast<float>(extent_m);
      range = DepthRange{*object.depth_m - 0.2F * reach_m, *object.depth_m + reach_m};
    }
    if (!range) continue;
    asked.range = *range;
    out.push_back(asked);
  }
  std::stable_sort(out.begin(), out.end(), [](const Asked& a, const Asked& b) {
    return a.range.min_m + a.range.max_m < b.range.min_m + b.range.max_m;
  });
  return out;
}

/// Groups of neighbouring cells that are judged to move and belong to nothing that was detected.
class MovingSurfaces {
 public:
  MovingSurfaces(const SightedFrame& frame) : odds_(*frame.odds), free_(odds_.moves) {
    for (const ObjectJudgement& object : frame.judgement.objects) leave_out(object.box);
    for (const MovingRegion& region : frame.judgement.regions) leave_out(region.box);
  }

  std::vector<std::vector<int>> groups(int least_cells) {
    std::vector<std::vector<int>> out;
    for (int i = 0; i < grid().cells(); ++i) {
      const std::vector<int>& group = grow(i);
      if (static_cast<int>(group.size()) >= least_cells) out.push_back(group);
    }
    return out;
  }

  std::vector<Reading> readings(const std::vector<int>& group) const {
    std::vector<Reading> out;
    const float side = static_cast<float>(grid().cell_px);
    for (const int i : group) {
      out.push_back({(static_cast<float>(i % grid().columns) + 0.5F) * side,
                     (static_cast<float>(i / grid().columns) + 0.5F) * side, z_m(i)});
    }
    return out;
  }
  float log_odds(const std::vector<int>& group) const {
    float sum = 0;
    for (const int i : group) sum += odds_.log_odds[static_cast<std::size_t>(i)];
    return sum / static_cast<float>(group.size());
  }

 private:
  const CellGrid& grid() const { return odds_.depth.grid; }
  float z_m(int cell) const { return odds_.depth.z_m[static_cast<std::size_t>(cell)]; }

  /// Limbs and shadows around an object are no things of their own.
  void leave_out(const Box& box) {
    const Box around = grown(box, 0.15F * std::max(box.width(), box.height()));
    const int x1 = std::min(grid().columns - 1, grid().cell_of(around.x1));
    const int y1 = std::min(grid().rows - 1, grid().cell_of(around.y1));
    for (int y = std::max(0, grid().cell_of(around.y0)); y <= y1; ++y) {
      for (int x = std::max(0, grid().cell_of(around.x0)); x <= x1; ++x) {
        free_[static_cast<std::size_t>(grid().index(x, y))] = 0;
      }
    }
  }

  /// The surface around a cell, which is taken away; empty: there is none. Until the next call.
  const std::vector<int>& grow(int start) {
    constexpr float kStepShare = 0.1F;  // of depth, from cell to cell
    std::vector<int>& group = group_;
    group.clear();
    const auto add = [&](int cell) {
      if (free_[static_cast<std::size_t>(cell)] == 0 || z_m(cell) <= 0) return;
      free_[static_cast<std::size_t>(cell)] = 0;
      group.push_back(cell);
    };
    add(start);
    for (std::size_t k = 0; k < group.size(); ++k) {
      const int cell = group[k], x = cell % grid().columns, y = cell / grid().columns;
      const auto step = [&](int column, int row) {
        if (!grid().contains(column, row)) return;
        const int next = grid().index(column, row);
        if (std::abs(z_m(next) - z_m(cell)) <= kStepShare * z_m(cell)) add(next);
      };
      step(x - 1, y);
      step(x + 1, y);
      step(x, y - 1);
      step(x, y + 1);
    }
    return group;
  }

  const MotionOdds& odds_;
  std::vector<int> group_;
  std::vector<std::uint8_t> free_;  ///< cells that move and belong to nothing yet
};

Box box_around(const std::vector<Reading>& readings, float margin_px) {
  Box box{readings[0].x_px, readings[0].y_px, readings[0].x_px, readings[0].y_px};
  for (const Reading& r : readings) {
    box = {std::min(box.x0, r.x_px), std::min(box.y0, r.y_px), std::max(box.x1, r.x_px),
           std::max(box.y1, r.y_px)};
  }
  return grown(box, margin_px);
}

std::vector<Sighting> unnamed_things(const SightedFrame& frame, const Measure& measure,
                                     const WorldTrackOptions& options, Quantile& quantile) {
  std::vector<Sighting> out;
  if (!frame.odds || frame.odds->empty()) return out;
  MovingSurfaces surfaces(frame);
  for (const std::vector<int>& group : surfaces.groups(options.thing_cells)) {
    const std::vector<Reading> readings = surfaces.readings(group);
    const float half_cell_px = 0.5F * static_cast<float>(frame.odds->depth.grid.cell_px);
    const Box box = box_around(readings, half_cell_px);
    const auto [near, far] =
        std::minmax_element(readings.begin(), readings.end(),
                            [](const Reading& a, const Reading& b) { return a.z_m < b.z_m; });
    Sighting sighting =
        measure.of(readings, box, 0, static_cast<double>(far->z_m - near->z_m), quantile);
    sighting.class_name = kThing;
    sighting.moves = true;
    sighting.log_odds = surfaces.log_odds(group);
    out.push_back(std::move(sighting));
  }
  return out;
}

/// What was measured of one detected object.
struct Measured {
  Sighting sighting;
  std::size_t readings = 0;
};

/// Two boxes on one body: the one with more readings is the person's.
bool is_told_already(std::vector<Measured>& others, const Measured& found) {
  constexpr double kOneBody_m = 0.3;  // from above
  for (Measured& other : others) {
    if (other.sighting.class_name != found.sighting.class_name) continue;
    const Eigen::Vector3d off_m = other.sighting.p_camera - found.sighting.p_camera;
    if (std::hypot(off_m.x(), off_m.z()) > kOneBody_m) continue;
    const bool sure = found.sighting.sure || other.sighting.sure;
    if (found.readings > other.readings) other = found;
    other.sighting.sure = sure;
    return true;
  }
  return false;
}

}  // namespace

std::vector<Sighting> find_sightings(const SightedFrame& frame, const Camera& camera,
                                     const ObjectCatalogue& catalogue, const SensorNoise& noise,
                                     const WorldTrackOptions& options) {
  if (frame.depth_m.empty()) return {};
  const Measure measure(camera, noise, options);
  Readings all(frame.depth_m);
  Quantile quantile;
  std::vector<Measured> objects;
  for (const Asked& asked : asked_of(frame, catalogue)) {
    const std::vector<Reading> readings = readings_of(asked, all, quantile);
    if (readings.size() < kLeastReadings) continue;
    all.take(readings);
    const ObjectJudgement& object = *asked.object;
    const double half_m = asked.person ? kBodyHalf_m : kSurfaceShare * asked.thickness_m;
    Sighting sighting = measure.of(readings, object.box, half_m, asked.thickness_m, quantile);
    const Detection& detection = frame.detections[static_cast<std::size_t>(object.detection)];
    sighting.class_name = detection.class_name;
    sighting.image_track = object.track;
    sighting.moves = object.rule != Rule::kept;
    sighting.log_odds = object.log_odds;
    sighting.sure = detection.sure || object.seen_to_move;
    const Measured found{std::move(sighting), readings.size()};
    if (!is_told_already(objects, found)) objects.push_back(found);
  }
  std::vector<Sighting> out;
  for (Measured& object : objects) out.push_back(std::move(object.sighting));
  const std::vector<Sighting> things = unnamed_things(frame, measure, options, quantile);
  out.insert(out.end(), things.begin(), things.end());
  return out;
}

}  // namespace ydd
