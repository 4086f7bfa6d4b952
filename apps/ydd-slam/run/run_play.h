// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "run/run_foxglove.h"
#include "run/run_job.h"
#include "run/run_pictures.h"
#include "run/run_recording.h"
#include "ydd/dataset/sequence.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/live/live_control.h"
#include "ydd/pictures/key_moments.h"
#include "ydd/system/run_recorder.h"
#include "ydd/system/track_recorder.h"

namespace ydd::app {

/// What a run reads; all of it outlives the run.
struct PlayInput {
  const Sequence& sequence;
  const Camera& camera;
  const RunRequest& request;
  const ObjectCatalogue& catalogue;
  const MotionSamples& motion;
};

/// Who hears of every frame.
struct Listeners {
  RunRecorder recorder;
  TrackRecorder tracks;
  KeyMoments moments;
  std::unique_ptr<RunPictures> pictures;    ///< null: none are asked for, or they failed
  std::string pictures_failure;             ///< empty: they did not
  std::unique_ptr<RunRecording> recording;  ///< null: none is asked for, or it failed
  std::string recording_failure;            ///< empty: it did not
  std::unique_ptr<RunFoxglove> foxglove;    ///< likewise
  std::string foxglove_failure;
};

/// How a run ended.
struct PlayEnd {
  std::string incomplete;  ///< why before the sequence did; empty: it did not
  std::string failure;     ///< one line; empty: none
};

/// What watchers of the run need to know beforehand. Ground truth that cannot be read is left out:
/// the report at the end tells why. A map that a watcher saves
/// goes to the request's file, else to map.ydd in `folder`.
LiveScene live_scene(const PlayInput& input, bool has_detector,
                     const std::filesystem::path& folder);

/// Plays the sequence to the system, frame by frame, until it ends, a watcher or a signal ends it,
/// or something fails; and finishes the system. `listeners` hear of every frame; `live` (may be
/// null) shows it to watchers and takes their commands.
PlayEnd play(const PlayInput& input, SlamSystem& system, Listeners& listeners, LiveControl* live);

}  // namespace ydd::app
