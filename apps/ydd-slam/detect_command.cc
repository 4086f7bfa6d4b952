// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "commands.h"
#include "common/default_detector.h"
#include "common/progress.h"
#include "common/terminal.h"
#include "ydd/base/files.h"
#include "ydd/base/interruption.h"
#include "ydd/base/timing.h"
#include "ydd/dataset/sequence.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/draw.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/detection/suggestions.h"
#include "ydd/image/decode.h"
#include "ydd/image/encode.h"
#include "ydd/sources/source.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

struct DetectRequest {
  std::string sequence;
  std::string detector;
  std::vector<std::string> set;
  std::string out;
  std::string pictures;
  std::string suggest;  ///< folder for frames to correct
  std::string objects;
  SequenceOptions sequence_options;
  int every = 1;
  int frames = 0;  ///< 0: all
  int suggestions = 30;
  int threads = 0;  ///< 0: as the library likes
  bool quiet = false;
};

/// What a detector saw in a sequence.
struct DetectRun {
  std::vector<RecordedFrame> frames;
  std::vector<double> detect_ms;
};

/// The colour picture alone: networks look at nothing else, and no camera is needed for it.
Result<RgbdFrame> read_picture(const Sequence& sequence, std::size_t index) {
  Result<ColourImage> colour = sequence.read_colour(index);
  if (!colour) return colour.error();
  RgbdFrame frame;
  frame.index = static_cast<std::int64_t>(index);
  frame.stamp = sequence.entry(index).stamp;
  frame.colour = *colour;
  return frame;
}

RecordedFrame record(const RgbdFrame& frame, const fs::path& file, Detections detections) {
  RecordedFrame out;
  out.stamp = frame.stamp;
  out.index = frame.index;
  out.file = file.generic_string();
  for (Detection& d : detections) {
    RecordedDetection recorded;
    recorded.detection = std::move(d);
    out.detections.push_back(std::move(recorded));
  }
  return out;
}

Result<void> write_picture(const std::string& folder, const RgbdFrame& frame,
                           const Detections& detections, const ObjectCatalogue& catalogue) {
  if (folder.empty()) return {};
  return write_png(fs::path(folder) / fmt::format("{:06}.png", frame.index),
                   draw_detections(frame.colour, detections, catalogue));
}

Result<DetectRun> detect_all(const Sequence& sequence, const DetectRequest& request,
                             Detector& detector, const ObjectCatalogue& catalogue) {
  const std::size_t end = request.frames > 0
                              ? std::min(sequence.size(), static_cast<std::size_t>(request.frames))
                              : sequence.size();
  DetectRun run;
  Progress progress(sequence.name(), end, request.quiet);
  for (std::size_t i = 0; i < end; i += static_cast<std::size_t>(request.every)) {
    interruption::throw_if_asked();
    const Result<RgbdFrame> frame = read_picture(sequence, i);
    if (!frame) return frame.error();
    const std::int64_t start_ns = wall_clock_ns();
    Result<Detections> found = detector.detect(*frame);
    if (!found) return Error{fmt::format("{}: {}", request.detector, found.error().message)};
    run.detect_ms.push_back(static_cast<double>(wall_clock_ns() - start_ns) * 1e-6);
    if (auto written = write_picture(request.pictures, *frame, *found, catalogue); !written) {
      return written.error();
    }
    progress.update(i + 1,
                    fmt::format("{} objects  {:.0f} ms", found->size(), run.detect_ms.back()));
    run.frames.push_back(record(
        *frame, fs::relative(sequence.entry(i).colour_name, sequence.place()), std::move(*found)));
  }
  return run;
}

Result<void> make_folder(const std::string& folder) {
  if (folder.empty()) return {};
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) return Error{fmt::format("{}: cannot be created: {}", folder, failure.message())};
  return {};
}

/// The detector of the request; for suggestions it also tells what it hardly believes.
Result<std::unique_ptr<Detector>> detector_for(const DetectRequest& request,
                                               const ObjectCatalogue& catalogue) {
  if (request.suggest.empty()) return make_detector(request.detector, request.set, catalogue);
  constexpr double kLeastScore = 0.1;
  Result<DetectorConfig> config = read_detector_config(request.detector, request.set);
  if (!config) return config.error();
  for (NetworkConfig& network : config->networks) {
    network.score_threshold = std::min(network.score_threshold, kLeastScore);
    network.class_thresholds.clear();
  }
  return make_detector(*config, catalogue);
}

Detections boxes_of(const RecordedFrame& frame) {
  Detections boxes;
  for (const RecordedDetection& d : frame.detections) boxes.push_back(d.detection);
  return boxes;
}

/// Picture and boxes of the frames of most doubt, spread over the recording.
Result<void> write_suggestions(const Sequence& sequence, const DetectRun& run,
                               const DetectRequest& request) {
  if (request.suggest.empty()) return {};
  std::vector<double> doubts;
  for (const RecordedFrame& frame : run.frames) doubts.push_back(doubt(boxes_of(frame)));
  const auto count = static_cast<std::size_t>(request.suggestions);
  const std::size_t gap = std::max<std::size_t>(1, doubts.size() / (2 * count));
  const std::vector<std::size_t> chosen = most_doubtful(doubts, count, gap);
  for (const std::size_t position : chosen) {
    const RecordedFrame& frame = run.frames[position];
    const auto index = static_cast<std::size_t>(frame.index.value_or(0));
    const Result<RgbdFrame> picture = read_picture(sequence, index);
    if (!picture) return picture.error();
    const fs::path name = fs::path(request.suggest) / fmt::format("{:06}", index);
    const fs::path file = fs::path(name).concat(".jpg");
    constexpr int kQuality = 93;
    if (auto written = write_jpeg(file, picture->colour, kQuality); !written) return written;
    const std::string labels = training_labels(boxes_of(frame));
    if (auto written = write_file_atomically(fs::path(name).concat(".json"), labels); !written) {
      return written;
    }
  }
  fmt::print("{} frames to correct in {}\n", chosen.size(), request.suggest);
  return {};
}

void print_summary(const DetectRun& run, const DetectRequest& request) {
  const SeriesStatistics ms = statistics_of(run.detect_ms);
  fmt::print("{} frames, {:.1f} ms each (median; 95 %: {:.1f})\n", run.frames.size(), ms.median,
             ms.p95);
  struct Count {
    int all = 0, sure = 0;
  };
  std::map<std::string, Count> by_class;
  for (const RecordedFrame& frame : run.frames) {
    for (const RecordedDetection& d : frame.detections) {
      Count& count = by_class[d.detection.class_name];
      ++count.all;
      count.sure += d.detection.sure ? 1 : 0;
    }
  }
  for (const auto& [name, count] : by_class) {
    fmt::print("  {:<20} {}{}\n", name, count.all,
               count.sure < count.all ? fmt::format(", {} of them sure", count.sure) : "");
  }
  fmt::print("detections in {}\n", request.out);
  if (!request.pictures.empty()) fmt::print("pictures in {}\n", request.pictures);
}

Result<void> detect_sequence(DetectRequest request) {
  if (request.detector.empty()) {
    Result<std::string> detector = default_detector();
    if (!detector) return detector.error();
    request.detector = *std::move(detector);
  }
  if (request.detector == kNoDetector) return Error{"detect needs a detector: --detector FILE"};
  const Result<Sequence> sequence = open_sequence(request.sequence, request.sequence_options);
  if (!sequence) return sequence.error();
  const Result<ObjectCatalogue> catalogue = request.objects.empty()
                                                ? ObjectCatalogue::defaults()
                                                : ObjectCatalogue::load(request.objects);
  if (!catalogue) return catalogue.error();
  if (request.threads > 0) cv::setNumThreads(request.threads);
  const auto detector = detector_for(request, *catalogue);
  if (!detector) return detector.error();
  for (const std::string& folder :
       {request.pictures, request.suggest, fs::path(request.out).parent_path().string()}) {
    if (auto made = make_folder(folder); !made) return made;
  }
  const Result<DetectRun> run = detect_all(*sequence, request, **detector, *catalogue);
  if (!run) return run.error();
  if (auto r = write_recorded_detections(request.out, run->frames); !r) return r;
  print_summary(*run, request);
  return write_suggestions(*sequence, *run, request);
}

}  // namespace

void add_detect_command(CLI::App& app, Job& job) {
  auto request = std::make_shared<DetectRequest>();
  auto* command =
      app.add_subcommand("detect", "Write the objects that networks see, to be replayed");
  command->add_option("sequence", request->sequence, "Recording: a folder or file")->required();
  command
      ->add_option("--source", request->sequence_options.source,
                   "What the recording is (default: as it looks; run --help lists them)")
      ->check(CLI::IsMember(source_names()));
  command->add_option("--topic-colour,--topic-color", request->sequence_options.topic_colour,
                      "Topic of a bag (default: told by encodings and names)");
  command->add_option("--topic-depth", request->sequence_options.topic_depth, "The same of depth");
  command->add_option("--detector", request->detector,
                      "Detector file (configs/detector/*.yaml; default: YDD_DETECTOR, else the "
                      "network of the program)");
  command->add_option("--out", request->out, "JSON lines to write")->required();
  command
      ->add_option("--set", request->set,
                   "Set one option of the detector file: key=value; * is every network")
      ->allow_extra_args(false);
  command->add_option("--pictures", request->pictures, "Folder for pictures with the boxes drawn");
  command->add_option("--suggest", request->suggest,
                      "Folder for the frames that the networks are least sure of, with their boxes "
                      "as training/ reads them; all boxes from a score of 0.1 on count then");
  command->add_option("--suggestions", request->suggestions, "Frames for --suggest at most")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  command->add_option("--objects", request->objects,
                      "Object catalogue (default: built in), for colours");
  command->add_option("--every", request->every, "Only every so many frames, for looking")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--frames", request->frames, "Stop after so many frames of the sequence")
      ->check(CLI::Range(0, 1'000'000'000));
  command->add_option("--threads", request->threads, "Threads of the networks")
      ->check(CLI::Range(0, 256));
  command->add_option("--associations", request->sequence_options.associations,
                      "File that pairs colour and depth images");
  command->add_option("--max-difference", request->sequence_options.max_difference_s,
                      "Largest time between paired images in seconds");
  add_quiet(*command, request->quiet);
  command->footer(
      "Models are looked for beside the detector file and in the folder YDD_MODELS.\n"
      "Examples:\n"
      "  ydd-slam detect office --out detections.jsonl --pictures seen\n"
      "  ydd-slam detect office --detector configs/detector/coco_body_head_hand.yaml \\\n"
      "    --set 'networks.*.input.width=320' --set 'networks.*.input.height=256' --out d.jsonl\n"
      "  ydd-slam run office --detections detections.jsonl --dynamic full");
  command->callback([request, &job] { job = [request] { return detect_sequence(*request); }; });
}

}  // namespace ydd::app
