// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "ydd/simulation/scene.h"
#include "ydd/simulation/world_options.h"

namespace ydd::sim {

/// Light of a black body as BGR, green 1, where 5500 K is white: Planck's law at 465, 550 and
/// 610 nm.
Eigen::Array3f colour_of_temperature(double temperature_k);

/// The light of a world over time: which sources shine, how brightly, in which colour, how far from
/// exact the camera's exposure is. Which day and which evening it is follows from
/// `options.light_seed`. Nothing for steady light.
std::optional<LightChanges> make_light_changes(const WorldOptions& options);

/// What the camera multiplies a picture by: its mean comes most of the way to that of a well lit
/// room, its colours half of the way to grey, as the automatics of cheap cameras do. BGR.
Eigen::Array3f automatic_gain(const std::vector<Eigen::Array3f>& colours, double exposure);

}  // namespace ydd::sim
