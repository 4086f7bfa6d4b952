// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/optimization/bundle_linearise.h"

/// The inertial links of a bundle problem as part of its normal equations: between poses that
/// follow each other, and to a border of further unknowns (speeds of the linked poses, then
/// inertial_order::kGlobals).
namespace ydd::bundle {

/// Fills what a layout says of the links of `problem`. @throws std::logic_error on an index out of
/// range or a link from a pose to itself.
void lay_out_inertial(const BundleProblem& problem, const std::vector<int>& columns,
                      Layout& layout);

/// Adds cost, gradients and Hessians of the links, and makes the border.
void add_inertial(const Layout& layout, const State& state, NormalEquations& equations);

/// What links and prior add to the cost. Links are under Huber's kernel always: a stretch of bad
/// samples must not bend the map.
double inertial_cost(const Layout& layout, const State& state);

InertialUnknowns moved(const Layout& layout, const InertialUnknowns& x,
                       const Eigen::VectorXd& step);

}  // namespace ydd::bundle
