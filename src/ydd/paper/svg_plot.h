// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace ydd {

/// A line, or separate pieces, in the units of the axes.
struct PlotLine {
  std::string name;    ///< for the key; empty: not in it
  std::string colour;  ///< CSS
  std::vector<Eigen::Vector2d> points;
  bool pieces = false;  ///< points 0-1, 2-3, ... are separate
  bool dashed = false;
};

/// Lines in one pair of axes.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotLine> lines;
  bool equal_axes = false;  ///< a metre is as long across as upwards
  bool from_zero = false;   ///< the upward axis begins at 0
};

/// The plot as an SVG element that needs nothing else; texts in it are text. Long lines are thinned
/// to what can be seen, peaks kept. A plot without points says so.
std::string svg_plot(const Plot& plot);

/// `text` with what HTML and XML would take for markup written otherwise.
std::string markup_text(const std::string& text);

}  // namespace ydd
