// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "run/run_job.h"
#include "ydd/detection/detector.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/geometry/camera.h"
#include "ydd/system/system_options.h"

namespace ydd::app {

/// What a run is configured with, and what it leaves as config.yaml.
struct Configuration {
  SystemOptions options;
  Camera camera;
  SequenceOptions sequence;

  void describe(OptionTable& table);
  std::string to_yaml() const;
};

/// Command line > file > default. The camera's default is that of the sequence; a saved
/// configuration has a camera too, so that it repeats its run wherever it is fed back.
struct ConfiguredRecording {
  Configuration configuration;
  Recording recording;
};
Result<ConfiguredRecording> effective_configuration(const RunRequest& request);

/// What the sensors of motion said that the command line names: files, or topics of the recording.
/// One of those that it does not name is used where the options say how it is mounted, and there is
/// no other of its kind; else a line of the log says that it is there.
Result<MotionSamples> run_motion(const RunRequest& request, const Recording& recording,
                                 const ReckoningOptions& options);

Result<ObjectCatalogue> run_catalogue(const RunRequest& request);

/// The request with the detector that it means: a run that rejects nothing, or replays recorded
/// boxes, looks at nothing.
Result<RunRequest> with_detector(RunRequest request, Variant variant);

/// Null: nothing is looked at.
Result<std::unique_ptr<Detector>> make_run_detector(const RunRequest& request,
                                                    const ObjectCatalogue& catalogue);

}  // namespace ydd::app
