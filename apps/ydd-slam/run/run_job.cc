// SPDX-License-Identifier: Apache-2.0
#include "run/run_job.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "common/default_detector.h"
#include "run/look_pace.h"
#include "run/run_configuration.h"
#include "run/run_folder.h"
#include "run/run_map.h"
#include "run/run_results.h"
#include "run/run_watch.h"
#include "ydd/base/cores.h"
#include "ydd/base/log.h"
#include "ydd/base/timing.h"

namespace ydd::app {
namespace {

/// Everything that a run reads, opened and checked before anything is computed.
struct Inputs {
  Configuration configuration;
  RunRequest request;  ///< with the detector that it means
  Sequence sequence;
  ObjectCatalogue catalogue;
  std::unique_ptr<Detector> detector;  ///< null: none
  MapKey map_key;
  RunMap map;
  MotionSamples motion;
};

/// Depth that is moved is reported: what the pictures show is not what the recording says.
void tell_depth_shift(const Sequence& sequence, const SequenceOptions& options) {
  const DepthShift shift = sequence.depth_shift();
  if (shift.none() || options.depth_shift != "auto") return;
  log::warning(
      "{}: depth lies {} px to the right of colour and {} px below it, and is moved back; "
      "calibrate the registration, or say --depth-shift 0,0 to leave it",
      sequence.place().string(), shift.right_px, shift.down_px);
}

/// Images without a partner are reported: they are not part of the run.
void tell_pairing(const Sequence& sequence, const SequenceOptions& options) {
  const std::optional<Pairing>& pairing = sequence.pairing();
  if (!pairing) return;
  log::info("{} pairs of {} colour and {} depth images", pairing->pairs, pairing->colour_images,
            pairing->depth_images);
  if (options.depth_offset == "auto") {
    log::info("depth offset found in the pictures: {:.4f} s", pairing->depth_offset_s);
  }
  const std::string warning = pairing_warning(*pairing, options.max_difference_s);
  if (!warning.empty()) log::warning("{}: {}", sequence.place().string(), warning);
}

/// Nobody can be left out of a picture whose boxes are unknown.
Result<void> check_redaction(const RunRequest& request, const Detector* detector,
                             const SystemOptions& options) {
  if (!request.redact) return {};
  if (!detector) {
    return Error{
        "--redact: people are left out by their boxes: name a detector (--detector) or recorded "
        "boxes (--detections)"};
  }
  if (options.detect.asynchronous()) {
    return Error{
        "--redact: needs the boxes of each frame; leave out --detect asynchronous "
        "(detect.mode)"};
  }
  return {};
}

Result<Inputs> open_inputs(const RunRequest& asked) {
  if (auto r = check_watchers(asked); !r) return r.error();
  Result<ConfiguredRecording> configured = effective_configuration(asked);
  if (!configured) return configured.error();
  Configuration& configuration = configured->configuration;
  Result<Sequence> sequence =
      Sequence::of(std::move(configured->recording), configuration.sequence);
  if (!sequence) return sequence.error();
  Result<RunRequest> request = with_detector(asked, configuration.options.dynamics.variant);
  if (!request) return request.error();
  if (sequence->is_live()) request->realtime = true;  // a camera waits for nobody
  Result<ObjectCatalogue> catalogue = run_catalogue(*request);
  if (!catalogue) return catalogue.error();
  Result<std::unique_ptr<Detector>> detector = make_run_detector(*request, *catalogue);
  if (!detector) {
    const bool by_default = asked.detector.empty() && asked.detections.empty();
    if (!by_default) return detector.error();
    return Error{detector.error().message + " (" + default_detector_origin() + ")"};
  }
  if (auto r = check_redaction(*request, detector->get(), configuration.options); !r) {
    return r.error();
  }
  Result<MapKey> map_key = run_map_key(*request);
  if (!map_key) return map_key.error();
  Result<RunMap> map =
      open_run_map(*request, *map_key, configuration.camera, configuration.options);
  if (!map) return map.error();
  Result<MotionSamples> motion =
      run_motion(*request, sequence->recording(), configuration.options.reckoning);
  if (!motion) return motion.error();
  return Inputs{std::move(configuration), *std::move(request),  *std::move(sequence),
                *std::move(catalogue),    *std::move(detector), *std::move(map_key),
                *std::move(map),          *std::move(motion)};
}

/// Replaces detect.mode "auto". Runs of equal bytes do not depend on how quick a machine is.
void settle_detect_mode(Inputs& inputs) {
  SystemOptions& options = inputs.configuration.options;
  if (options.detect.asynchronous()) return;
  if (inputs.request.redact) options.detect.mode = DetectMode::every_frame;
  const bool looks = inputs.detector != nullptr && !inputs.request.detector.empty();
  if (!looks || options.deterministic) {
    options.detect.mode = DetectMode::every_frame;
    return;
  }
  const std::optional<LookPace> pace =
      measure_look(*inputs.detector, inputs.sequence, inputs.configuration.camera);
  const DetectChoice choice = choose_detect_mode(options.detect.mode, pace.value_or(LookPace{}),
                                                 inputs.request.realtime, available_cores());
  options.detect.mode = choice.mode;
  if (!choice.message.empty()) log::info("{}", choice.message);
}

/// Who writes files while the run goes on.
Result<Listeners> open_listeners(const Inputs& inputs) {
  const RunRequest& request = inputs.request;
  const Camera& camera = inputs.configuration.camera;
  Listeners out;
  auto pictures = RunPictures::open(request, camera, inputs.catalogue);
  if (!pictures) return pictures.error();
  out.pictures = *std::move(pictures);
  auto recording = RunRecording::open(request.record, camera);
  if (!recording) return recording.error();
  out.recording = *std::move(recording);
  if (out.recording) out.recording->add(inputs.motion);
  auto foxglove = RunFoxglove::open(request);
  if (!foxglove) return foxglove.error();
  out.foxglove = *std::move(foxglove);
  return out;
}

/// One line of all that went wrong; empty: nothing did.
std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + "; " + b;
}

RunOutcome outcome_of(const RunResults& results, const std::string& write_failures) {
  const RunRecorder& recorder = results.listeners.recorder;
  std::string failure = joined(results.end.failure, results.listeners.pictures_failure);
  failure = joined(failure, results.listeners.recording_failure);
  failure = joined(failure, results.listeners.foxglove_failure);
  return {results.folder,
          results.summary,
          recorder.timings_json(results.system),
          results.system.trajectory(),
          results.groundtruth_file,
          results.system.atlas(),
          recorder.processed(),
          recorder.tracked(),
          results.end.incomplete,
          joined(failure, write_failures)};
}

}  // namespace

Result<RunOutcome> run_sequence(const RunRequest& asked) {
  Result<Inputs> inputs = open_inputs(asked);
  if (!inputs) return inputs.error();
  const RunRequest& request = inputs->request;
  const Camera& camera = inputs->configuration.camera;
  Result<RunFolder> folder = RunFolder::make(request.out, inputs->sequence.name());
  if (!folder) return folder.error();
  Result<Listeners> opened = open_listeners(*inputs);
  if (!opened) return opened.error();
  Listeners& listeners = *opened;

  tell_pairing(inputs->sequence, inputs->configuration.sequence);
  tell_depth_shift(inputs->sequence, inputs->configuration.sequence);
  settle_detect_mode(*inputs);
  const bool has_detector = inputs->detector != nullptr;
  const std::string device = has_detector ? inputs->detector->device() : "";
  SlamSystem system = make_run_system(camera, inputs->configuration.options, inputs->catalogue,
                                      std::move(inputs->detector), std::move(inputs->map));
  if (auto r = prepare_run_map(request, inputs->map_key, system); !r) return r.error();
  const std::int64_t start_ns = wall_clock_ns();
  const PlayInput input{inputs->sequence, camera, request, inputs->catalogue, inputs->motion};
  const Result<PlayEnd> end = play_watched(input, system, listeners, has_detector, folder->path());
  if (!end) return end.error();
  if (listeners.recorder.processed() == 0) {  // there is nothing to write
    return Error{end->failure.empty() ? end->incomplete : end->failure};
  }
  const double wall_s = static_cast<double>(wall_clock_ns() - start_ns) * 1e-9;

  RunResults results{request,
                     inputs->configuration,
                     inputs->sequence,
                     inputs->catalogue,
                     system,
                     listeners,
                     *end,
                     folder->path(),
                     has_detector,
                     device,
                     {},
                     {}};
  Attempts attempts;
  results.groundtruth_file = place_groundtruth(results, attempts);
  results.summary = summary_of(results, wall_s);
  write_results(results, attempts);
  folder->keep();
  return outcome_of(results, attempts.failures());
}

Result<RunOutcome> run_whole_sequence(const RunRequest& request) {
  Result<RunOutcome> outcome = run_sequence(request);
  if (!outcome) return outcome;
  if (!outcome->failure.empty()) return Error{outcome->failure};
  if (!outcome->incomplete.empty()) return Error{outcome->incomplete};
  return outcome;
}

}  // namespace ydd::app
