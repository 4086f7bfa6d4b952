// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "run/run_play.h"

namespace ydd::app {

/// Fails with one line when the request wants to be watched in a way that this program was built
/// without, or at an address that is none.
Result<void> check_watchers(const RunRequest& request);

/// `play`, while whoever the request names looks on: a window (`--view`), which takes the calling
/// thread for as long as it is open (screenshots go to `folder`), and a web page (`--serve`).
Result<PlayEnd> play_watched(const PlayInput& input, SlamSystem& system, Listeners& listeners,
                             bool has_detector, const std::filesystem::path& folder);

}  // namespace ydd::app
