// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/map_inset.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "ydd/pictures/map_from_above.h"

namespace ydd {
namespace {

constexpr std::size_t kMostPoints = 4000;
constexpr double kLeastExtent_m = 1.0;
const cv::Vec3b kPoint(140, 130, 120);
const cv::Scalar kGround(34, 28, 24), kPath(255, 150, 60), kTracking(80, 220, 60),
    kLost(60, 60, 255), kText(230, 230, 230);

/// Metres to pixels: shows the path and all but the farthest points.
class Scale {
 public:
  Scale(const MapFromAbove& drawing, int width_px, int height_px)
      : middle_px_(width_px / 2.0, height_px / 2.0) {
    Eigen::AlignedBox2d box;
    for (const int axis : {0, 1}) extend(drawing.points, axis, box);
    for (const Eigen::Vector2d& p : drawing.path) box.extend(p);
    if (box.isEmpty()) return;
    centre_ = box.center();
    const Eigen::Vector2d size = box.sizes().cwiseMax(kLeastExtent_m) * 1.15;
    px_per_m_ = std::min(width_px / size.x(), height_px / size.y());
  }
  cv::Point operator()(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d at = px_per_m_ * (p - centre_);
    return {cvRound(middle_px_.x() + at.x()), cvRound(middle_px_.y() - at.y())};
  }
  double px_per_m() const { return px_per_m_; }

 private:
  /// A few points far off must not make the rest small.
  static void extend(const std::vector<Eigen::Vector2d>& points, int axis,
                     Eigen::AlignedBox2d& box) {
    if (points.empty()) return;
    std::vector<double> values;
    for (const Eigen::Vector2d& p : points) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    const double low = values[values.size() / 50], high = values[values.size() * 49 / 50];
    box.min()[axis] = std::min(box.min()[axis], low);
    box.max()[axis] = std::max(box.max()[axis], high);
  }

  Eigen::Vector2d middle_px_;
  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
  double px_per_m_ = 1;
};

void draw_camera(cv::Mat& canvas, const MapFromAbove& drawing, const Scale& scale, bool lost) {
  if (drawing.path.empty()) return;
  const cv::Point at = scale(drawing.path.back());
  const double angle_deg = -std::atan2(drawing.ahead.y(), drawing.ahead.x()) * 180.0 / CV_PI;
  cv::ellipse(canvas, at, {13, 13}, angle_deg, -28, 28, lost ? kLost : kTracking, cv::FILLED,
              cv::LINE_AA);
}

/// A bar of 1, 2 or 5 times a power of ten metres, at least a sixth of the width.
void draw_bar(cv::Mat& canvas, const Scale& scale) {
  const double least_m = canvas.cols / 6.0 / scale.px_per_m();
  const double power = std::pow(10.0, std::floor(std::log10(least_m)));
  const double length_m = power * (least_m <= power       ? 1
                                   : least_m <= 2 * power ? 2
                                   : least_m <= 5 * power ? 5
                                                          : 10);
  const int length_px = cvRound(length_m * scale.px_per_m());
  const cv::Point left(6, canvas.rows - 6);
  cv::line(canvas, left, left + cv::Point(length_px, 0), kText, 1);
  cv::putText(canvas, fmt::format("{:g} m", length_m), left + cv::Point(0, -4),
              cv::FONT_HERSHEY_SIMPLEX, 0.35, kText, 1, cv::LINE_AA);
}

}  // namespace

void MapInset::add(const FrameReport& report) {
  lost_ = report.track.state == TrackingState::lost;
  if (report.track.state != TrackingState::tracking) return;
  path_.push_back({report.stamp, report.track.reference, report.track.T_reference_camera});
}

ColourImage MapInset::draw(const Atlas& atlas, int width_px, int height_px) const {
  std::vector<Bgr> pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  cv::Mat canvas(height_px, width_px, CV_8UC3, pixels.data());
  canvas.setTo(kGround);
  const MapFromAbove drawing = map_from_above(atlas, path_, kMostPoints);
  const Scale scale(drawing, width_px, height_px);
  const cv::Rect inside({0, 0}, canvas.size());
  for (const Eigen::Vector2d& p : drawing.points) {
    const cv::Point at = scale(p);
    if (inside.contains(at)) canvas.at<cv::Vec3b>(at) = kPoint;
  }
  std::vector<cv::Point> path;
  for (const Eigen::Vector2d& p : drawing.path) path.push_back(scale(p));
  if (!path.empty()) cv::polylines(canvas, path, false, kPath, 1, cv::LINE_AA);
  draw_camera(canvas, drawing, scale, lost_);
  if (!drawing.path.empty()) draw_bar(canvas, scale);
  return {width_px, height_px, std::move(pixels)};
}

}  // namespace ydd
