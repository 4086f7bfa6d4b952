// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ydd {

/// The live page: one HTML file with its scripts and the plotting library (dygraphs, MIT) inside.
/// It asks its server for state.json, map.json and frame.jpg, and nobody else for anything.
std::string live_page();

}  // namespace ydd
