// SPDX-License-Identifier: Apache-2.0
#include "ydd/paper/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace ydd {
namespace {

constexpr double kWidth_px = 420, kHeight_px = 260;
constexpr double kLeft_px = 58, kRight_px = 12, kTop_px = 26, kBottom_px = 58;
constexpr std::size_t kMaxPoints = 800;

/// What is seen, in the units of the axes.
struct Frame {
  Eigen::Vector2d low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  Eigen::Vector2d high = -low;
  bool empty() const { return low.x() > high.x(); }
  Eigen::Vector2d size() const { return high - low; }
};

Frame bounds_of(const Plot& plot) {
  Frame frame;
  for (const PlotLine& line : plot.lines) {
    for (const Eigen::Vector2d& p : line.points) {
      frame.low = frame.low.cwiseMin(p);
      frame.high = frame.high.cwiseMax(p);
    }
  }
  if (frame.empty()) return frame;
  if (plot.from_zero) frame.low.y() = std::min(0.0, frame.low.y());
  for (int axis = 0; axis < 2; ++axis) {
    // A straight line still wants a width.
    const double room = std::max(0.03 * frame.size()[axis], 1e-6);
    if (axis == 1 && !plot.from_zero) frame.low[axis] -= room;
    frame.high[axis] += room;
  }
  return frame;
}

/// Widens the axis that has more pixels than it needs.
void make_equal(Frame& frame) {
  const Eigen::Vector2d pixels(kWidth_px - kLeft_px - kRight_px, kHeight_px - kTop_px - kBottom_px);
  const double scale = std::max(frame.size().x() / pixels.x(), frame.size().y() / pixels.y());
  const Eigen::Vector2d more = (scale * pixels - frame.size()) / 2;
  frame.low -= more;
  frame.high += more;
}

Eigen::Vector2d to_px(const Frame& frame, const Eigen::Vector2d& p) {
  const Eigen::Vector2d share = (p - frame.low).cwiseQuotient(frame.size());
  return {kLeft_px + share.x() * (kWidth_px - kLeft_px - kRight_px),
          kHeight_px - kBottom_px - share.y() * (kHeight_px - kTop_px - kBottom_px)};
}

/// 1, 2 or 5 times a power of ten, so that about five fit.
double tick_step(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 5)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (range / (factor * power) <= 6) return factor * power;
  }
  return 10 * power;
}

std::string tick(const Frame& frame, int axis, double value) {
  const bool across = axis == 0;
  const Eigen::Vector2d at = to_px(frame, across ? Eigen::Vector2d(value, frame.low.y())
                                                 : Eigen::Vector2d(frame.low.x(), value));
  const Eigen::Vector2d to =
      across ? Eigen::Vector2d(at.x(), kTop_px) : Eigen::Vector2d(kWidth_px - kRight_px, at.y());
  // Rounding leaves a "-0" beside the axis.
  const double shown = std::abs(value) < 1e-12 ? 0.0 : value;
  return fmt::format(
      "<path class=\"grid\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>"
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{:.4g}</text>\n",
      at.x(), at.y(), to.x(), to.y(), at.x() - (across ? 0 : 6), at.y() + (across ? 15 : 4),
      across ? "middle" : "end", shown);
}

std::string ticks(const Frame& frame) {
  std::string out;
  for (int axis = 0; axis < 2; ++axis) {
    const double step = tick_step(frame.size()[axis]);
    const double first = std::ceil(frame.low[axis] / step);
    const double last = std::floor(frame.high[axis] / step);
    for (double i = first; i <= last; ++i) out += tick(frame, axis, i * step);
  }
  return out;
}

/// The lowest and highest of each stretch, in their order.
std::vector<Eigen::Vector2d> thinned(const PlotLine& line) {
  const std::vector<Eigen::Vector2d>& points = line.points;
  if (line.pieces || points.size() <= kMaxPoints) return points;
  std::vector<Eigen::Vector2d> out;
  const std::size_t stretch = 2 * points.size() / kMaxPoints + 1;
  for (std::size_t begin = 0; begin < points.size(); begin += stretch) {
    const auto from = points.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to =
        points.begin() + static_cast<std::ptrdiff_t>(std::min(begin + stretch, points.size()));
    auto [low, high] =
        std::minmax_element(from, to, [](const auto& a, const auto& b) { return a.y() < b.y(); });
    if (high < low) std::swap(low, high);
    out.push_back(*low);
    if (low != high) out.push_back(*high);
  }
  return out;
}

std::string path_of(const Frame& frame, const PlotLine& line) {
  std::string d;
  const std::vector<Eigen::Vector2d> points = thinned(line);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d p = to_px(frame, points[i]);
    const bool starts = line.pieces ? i % 2 == 0 : i == 0;
    d += fmt::format("{}{:.1f} {:.1f}", starts ? 'M' : 'L', p.x(), p.y());
  }
  return fmt::format("<path class=\"line\" stroke=\"{}\"{} d=\"{}\"/>\n", markup_text(line.colour),
                     line.dashed ? " stroke-dasharray=\"5 4\"" : "", d);
}

std::string key_of(const Plot& plot) {
  std::string out;
  double x = kLeft_px;
  for (const PlotLine& line : plot.lines) {
    if (line.name.empty()) continue;
    const double y = kHeight_px - 8;
    out += fmt::format(
        "<path class=\"line\" stroke=\"{}\"{} d=\"M{:.0f} {:.0f}h18\"/>"
        "<text x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n",
        markup_text(line.colour), line.dashed ? " stroke-dasharray=\"5 4\"" : "", x, y - 4, x + 22,
        y, markup_text(line.name));
    x += 34 + 6.3 * static_cast<double>(line.name.size());
  }
  return out;
}

}  // namespace

std::string markup_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string svg_plot(const Plot& plot) {
  std::string out = fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" xmlns=\"http://www.w3.org/2000/svg\">\n"
      "<title>{}</title>\n<text class=\"title\" x=\"{:.0f}\" y=\"16\">{}</text>\n",
      kWidth_px, kHeight_px, markup_text(plot.title), kLeft_px, markup_text(plot.title));
  Frame frame = bounds_of(plot);
  if (frame.empty()) {
    return out + fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\">nothing to draw</text>\n</svg>\n",
                             kLeft_px, kHeight_px / 2);
  }
  if (plot.equal_axes) make_equal(frame);
  out += ticks(frame);
  for (const PlotLine& line : plot.lines) out += path_of(frame, line);
  out += fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\">{}</text>\n"
      "<text transform=\"translate(12 {:.0f}) rotate(-90)\" text-anchor=\"end\">{}</text>\n",
      kWidth_px - kRight_px, kHeight_px - 28, markup_text(plot.x_label), kTop_px,
      markup_text(plot.y_label));
  return out + key_of(plot) + "</svg>\n";
}

}  // namespace ydd
