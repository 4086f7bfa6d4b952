// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/annotate.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "ydd/detection/draw.h"

namespace ydd {
namespace {

constexpr int kLineHeight_px = 14;
constexpr int kPointRadius_px = 2;
constexpr double kFontScale = 0.42;
constexpr double kTint = 0.3;  // share of the colour where a surface moves

cv::Scalar scalar(Bgr c) { return {double(c[0]), double(c[1]), double(c[2])}; }

cv::Point pixel(const Keypoint& k) { return {cvRound(k.x_px), cvRound(k.y_px)}; }

void draw_text(cv::Mat& canvas, const std::string& text, cv::Point at, const cv::Scalar& colour) {
  // A dark rim keeps text readable on any background.
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, kFontScale, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, kFontScale, colour, 1, cv::LINE_AA);
}

void draw_kept(cv::Mat& canvas, const FrameReport& report) {
  const Features& f = *report.filtered->kept;
  for (std::size_t i = 0; i < f.size(); ++i) {
    const bool mapped = i < report.points.size() && report.points[i].valid();
    cv::circle(canvas, pixel(f.keypoints[i]), kPointRadius_px,
               mapped ? cv::Scalar(0, 255, 0) : cv::Scalar(0, 120, 0), cv::FILLED, cv::LINE_AA);
  }
}

void draw_rejected(cv::Mat& canvas, const FrameReport& report) {
  for (const RejectedPoint& p : report.filtered->rejected) {
    cv::circle(canvas, pixel(p.keypoint), kPointRadius_px, scalar(colour_of(p.rule)), 1,
               cv::LINE_AA);
  }
}

void draw_legend(cv::Mat& canvas, const FrameReport& report) {
  const auto counts = count_rules(*report.filtered);
  int y = canvas.rows - 8;
  for (std::size_t i = counts.size(); i-- > 1;) {
    if (counts[i] == 0) continue;
    const Rule rule = static_cast<Rule>(i);
    cv::circle(canvas, {10, y - 4}, 4, scalar(colour_of(rule)), cv::FILLED, cv::LINE_AA);
    draw_text(canvas, fmt::format("{} {}", to_string(rule), counts[i]), {20, y}, {255, 255, 255});
    y -= kLineHeight_px;
  }
}

/// What the evidence says of an object: its verdict, and how likely it is to move.
std::string odds_label(const ObjectJudgement& object) {
  const double moves = 1.0 / (1.0 + std::exp(-double(*object.log_odds)));
  return object.rule == Rule::kept ? fmt::format("stands still {:.0f} %", 100.0 * (1.0 - moves))
                                   : fmt::format("moves {:.0f} %", 100.0 * moves);
}

/// Into the upper left corner of each box, below what stands on top of the picture, and below each
/// other where boxes overlap.
void draw_odds(cv::Mat& canvas, std::span<const ObjectJudgement> objects) {
  constexpr int kTop_px = 20, kMargin_px = 4;
  std::vector<cv::Rect> taken;
  for (const ObjectJudgement& object : objects) {
    if (!object.log_odds) continue;
    const std::string text = odds_label(object);
    const int width = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kFontScale, 1, nullptr).width;
    const int left = cvRound(object.box.x0) + kMargin_px;
    cv::Rect at(std::clamp(left, 0, std::max(0, canvas.cols - width)),
                std::max(cvRound(object.box.y0), kTop_px), width, kLineHeight_px);
    const auto overlaps = [&](const cv::Rect& other) { return !(other & at).empty(); };
    while (std::any_of(taken.begin(), taken.end(), overlaps)) at.y += kLineHeight_px;
    taken.push_back(at);
    draw_text(canvas, text, {at.x, at.y + kLineHeight_px - 3},
              object.rule == Rule::kept ? cv::Scalar(110, 255, 110) : cv::Scalar(110, 110, 255));
  }
}

/// The picture with surfaces that are seen to move in a tint, whether or not a box is round them.
ColourImage tint_moving(const ColourImage& image, const MotionOdds& odds) {
  std::vector<Bgr> pixels(image.data(), image.data() + std::size_t(image.width()) * image.height());
  cv::Mat canvas(image.height(), image.width(), CV_8UC3, pixels.data());
  const CellGrid& grid = odds.depth.grid;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (odds.moves[static_cast<std::size_t>(grid.index(column, row))] == 0) continue;
      const cv::Rect side(0, 0, grid.cell_px, grid.cell_px);
      const cv::Rect place = side + cv::Point(column * grid.cell_px, row * grid.cell_px);
      cv::Mat cell = canvas(place & cv::Rect({0, 0}, canvas.size()));
      cv::addWeighted(cell, 1 - kTint,
                      cv::Mat(cell.size(), CV_8UC3, scalar(colour_of(Rule::seen_moving))), kTint, 0,
                      cell);
    }
  }
  return {image.width(), image.height(), std::move(pixels)};
}

std::string state_line(const FrameReport& report, double frames_per_second) {
  std::string line = fmt::format("frame {}  {}  {} map points  kept {} of {}", report.index,
                                 to_string(report.track.state), report.track.inliers,
                                 report.filtered->kept->size(), report.filtered->extracted());
  if (frames_per_second > 0) line += fmt::format("  {:.1f} fps", frames_per_second);
  return line;
}

/// Into the top right corner, below the line of state, with a thin frame.
void draw_map(cv::Mat& canvas, const ColourImage& map) {
  constexpr int kMargin_px = 8, kTop_px = 24;
  const cv::Rect at(canvas.cols - map.width() - kMargin_px, kTop_px, map.width(), map.height());
  if (map.empty() || (at & cv::Rect({0, 0}, canvas.size())) != at) return;
  const cv::Mat inset(map.height(), map.width(), CV_8UC3,
                      const_cast<Bgr*>(map.data()));  // NOLINT(*-const-cast): read only
  cv::Mat corner = canvas(at);
  cv::addWeighted(inset, 0.85, corner, 0.15, 0, corner);
  cv::rectangle(canvas, at, {200, 200, 200}, 1);
}

}  // namespace

Bgr colour_of(Rule rule) {
  static constexpr std::array<Bgr, kRuleCount> kColours = {{
      {0, 255, 0},      // kept
      {255, 0, 255},    // box
      {60, 60, 255},    // body_depth
      {200, 60, 160},   // automatic_depth
      {0, 160, 255},    // moved_by_hand
      {0, 220, 255},    // moved_near_body
      {255, 255, 0},    // edge
      {180, 105, 255},  // around_hand
      {128, 0, 255},    // full_depth_failed
      {255, 80, 80},    // full_small_box
      {200, 0, 200},    // full_entangled
      {255, 160, 0},    // seen_moving
      {160, 160, 255},  // surrounded
      {0, 128, 255},    // lone_part
      {200, 200, 0},    // connected
      {255, 200, 200},  // bridged
  }};
  return kColours[std::min(static_cast<std::size_t>(rule), kColours.size() - 1)];
}

ColourImage annotate(const RgbdFrame& frame, const FrameReport& report,
                     const ObjectCatalogue& catalogue, const AnnotateExtras& extras) {
  const bool tinted = report.odds && !report.odds->empty();
  const ColourImage boxes =
      draw_detections(tinted ? tint_moving(frame.colour, *report.odds) : frame.colour,
                      report.detections, catalogue);
  std::vector<Bgr> pixels(boxes.data(), boxes.data() + std::size_t(boxes.width()) * boxes.height());
  cv::Mat canvas(boxes.height(), boxes.width(), CV_8UC3, pixels.data());
  draw_rejected(canvas, report);
  draw_kept(canvas, report);
  draw_map(canvas, extras.map);
  draw_odds(canvas, report.judgement.objects);
  draw_legend(canvas, report);
  draw_text(canvas, state_line(report, extras.frames_per_second), {8, 16}, {255, 255, 255});
  return {boxes.width(), boxes.height(), std::move(pixels)};
}

}  // namespace ydd
