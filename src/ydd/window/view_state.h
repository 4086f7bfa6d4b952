// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ydd/live/live_control.h"
#include "ydd/viewer/map_scene.h"

namespace ydd {

/// How the map's eye moves by itself.
enum class EyeMode {
  follow,  ///< keeps the moving camera in the middle
  free,    ///< stays where the mouse left it
  top,     ///< follows from straight above
};

/// What the user has chosen to see. Lives as long as the window.
struct ViewState {
  bool points = true, keyframes = true, covisibility = true, loops = true;
  bool trajectory = true, truth = true, errors = true, grid = true, tracks = true;
  bool dense = false;
  EyeMode eye = EyeMode::follow;
};

/// What the user asked for in one pass over the panels.
struct PanelRequests {
  std::vector<LiveCommand> commands;
  bool screenshot = false;
  bool fit = false;
  bool close = false;
  bool ask_reset = false;  ///< by key: the toolbar asks whether it is meant
};

/// What panels tell about a run: gathered when a new frame is there, not at every redraw.
struct PanelFacts {
  std::shared_ptr<const LiveFrame> live;  ///< never null
  std::vector<LiveSample> recent;         ///< the newest, oldest first
  std::size_t frames = 0;                 ///< of the run; 0: unknown
  std::string sequence;
  bool has_detector = false;
  bool has_truth = false;
  int keyframes = 0, points = 0, maps = 0, loops = 0;
  std::optional<double> error_rmse_m;
};

}  // namespace ydd
