// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/closed_curve.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace ydd::sim {
namespace {

constexpr int kStepsPerSpan = 128;

}  // namespace

ClosedCurve::ClosedCurve(std::vector<Eigen::Vector2d> waypoints)
    : waypoints_(std::move(waypoints)) {
  if (waypoints_.size() < 3) throw std::logic_error("ClosedCurve: needs three waypoints");
  const int steps = kStepsPerSpan * static_cast<int>(waypoints_.size());
  arc_.push_back(0.0);
  Eigen::Vector2d last = evaluate(0.0);
  for (int i = 1; i <= steps; ++i) {
    const Eigen::Vector2d p = evaluate(static_cast<double>(i) / kStepsPerSpan);
    arc_.push_back(arc_.back() + (p - last).norm());
    last = p;
  }
}

Eigen::Vector2d ClosedCurve::evaluate(double parameter) const {
  const auto count = static_cast<int>(waypoints_.size());
  const int span = static_cast<int>(std::floor(parameter));
  const double t = parameter - span;
  const auto point = [&](int i) -> const Eigen::Vector2d& {
    return waypoints_[static_cast<std::size_t>(((span + i) % count + count) % count)];
  };
  const double s = 1.0 - t;
  const double w0 = s * s * s / 6.0;
  const double w1 = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
  const double w2 = (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0;
  const double w3 = t * t * t / 6.0;
  return w0 * point(-1) + w1 * point(0) + w2 * point(1) + w3 * point(2);
}

Eigen::Vector2d ClosedCurve::at(double distance_m) const {
  const double wrapped = distance_m - std::floor(distance_m / length_m()) * length_m();
  const auto upper = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, wrapped);
  const auto i = static_cast<std::size_t>(upper - arc_.begin());
  const double t = (wrapped - arc_[i - 1]) / (arc_[i] - arc_[i - 1]);
  return evaluate((static_cast<double>(i - 1) + t) / kStepsPerSpan);
}

}  // namespace ydd::sim
