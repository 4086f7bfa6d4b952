// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "commands.h"
#include "common/terminal.h"
#include "run/run_job.h"
#include "ydd/base/interruption.h"
#include "ydd/base/log.h"
#include "ydd/sources/source.h"

namespace ydd::app {
namespace {

void add_input_options(CLI::App& command, RunRequest& request) {
  command
      .add_option("sequence", request.sequence,
                  "Recording or camera: folder, file, name; see below")
      ->required();
  command.add_option("--source", request.source, "What the recording is (default: as it looks)")
      ->check(CLI::IsMember(source_names()));
  command.add_option("--topic-colour,--topic-color", request.topic_colour,
                     "Topic of a bag (default: told by encodings and names)");
  command.add_option("--topic-depth", request.topic_depth, "The same of depth");
  command.add_option("--topic-camera-info", request.topic_camera_info, "The same of the camera");
  command.add_option("--mode", request.camera_mode,
                     "Mode of a camera, such as 640x480@30 (default: chosen)");
  command.add_option("--camera", request.camera,
                     "Camera file (our own, ORB-SLAM, stella_vslam, ROS, OpenCV, ...) or preset");
  command.add_option("--associations", request.associations,
                     "File that pairs colour and depth images");
  command.add_option("--max-difference", request.max_difference_s,
                     "Largest time between paired images in seconds");
  command.add_option("--depth-offset", request.depth_offset,
                     "Seconds to add to the stamps of depth images, or auto: look at the pictures");
  command.add_option("--depth-shift", request.depth_shift,
                     "Pixels RIGHT,DOWN that depth lies off colour, or auto: look at the pictures");
  command
      .add_option("--start-frame", request.first_frame, "Leave out so many frames at the beginning")
      ->check(CLI::Range(0, 1000000000));
  command.add_option("--max-frames", request.max_frames, "Stop after so many frames (0: all)")
      ->check(CLI::Range(0, 1000000000));
  command.add_option("--imu", request.imu,
                     "What an IMU said: file of stamp, rad/s, m/s^2 (EuRoC CSV), topic of the "
                     "bag, or off; see reckoning.*");
  command.add_option("--odometry", request.odometry,
                     "Odometry of a robot: trajectory file of its base, topic of the bag, or "
                     "off; see reckoning.*");
  command.add_flag("--strict", request.strict, "A frame that cannot be read ends the run");
  command.add_flag("--realtime", request.realtime, "Keep the camera's pace, drop what is late");
}

void add_method_options(CLI::App& command, RunRequest& request) {
  command.add_option("--config", request.config, "YAML file with options");
  command.add_option("--set", request.set, "Set one option: key=value")->allow_extra_args(false);
  command.add_option("--dynamic", request.dynamic,
                     "What is rejected: off | box | person | full | evidence (default: by what the "
                     "last frames show, with a detector or without)");
  command.add_option("--detector", request.detector,
                     "Detector YAML (configs/detector/) that looks for objects; none: no "
                     "detector (default: YDD_DETECTOR, else the network of the program)");
  command.add_option("--detector-set", request.detector_set, "Set one detector option: key=value")
      ->allow_extra_args(false);
  command.add_option("--detect", request.detect,
                     "auto (default), every-frame: tracking waits for the boxes of each frame; "
                     "asynchronous: it never waits, boxes are carried on");
  command.add_option("--detections", request.detections, "Replay recorded detections (JSON lines)");
  command.add_option("--objects", request.objects, "Object catalogue YAML (configs/objects.yaml)");
  command.add_option("--seed", request.seed, "Seed of every random choice");
  command.add_flag("--deterministic", request.deterministic, "Equal results to the byte");
}

void add_map_options(CLI::App& command, RunRequest& request) {
  auto* map = command.add_option("--map", request.map,
                                 "Map file to go on with: find one's place in it, extend it");
  auto* save = command.add_option("--save-map", request.save_map,
                                  "Map file to write, every few seconds and at the end");
  add_map_key(command, request.map_key);
  command
      .add_flag("--replace-map", request.replace_map,
                "Let --save-map replace a map that holds more than the new one")
      ->needs(save);
  command
      .add_flag("--localization-only", request.localization_only,
                "Use the map of --map without changing it")
      ->needs(map)
      ->excludes(save);
}

void add_result_options(CLI::App& command, RunRequest& request) {
  command.add_option("--out", request.out, "Folder for results (default runs/<sequence>-<time>)");
  command
      .add_option("--trajectory-format", request.trajectory_format,
                  "Also write the trajectory as kitti or euroc")
      ->check(CLI::IsMember({"tum", "kitti", "euroc"}));
  command.add_option("--frames", request.pictures,
                     "Folder for a picture of each frame: boxes, kept and rejected points, map");
  command.add_option("--frames-every", request.pictures_every, "Only of every N-th frame")
      ->check(CLI::Range(1, 1000000));
  command.add_option("--video", request.video, "MP4 file with these pictures as a video");
  command.add_option("--mcap", request.mcap,
                     "File (.mcap) for Foxglove: pictures, poses, points, people and things");
  CLI::Option* record = command.add_option(
      "--record", request.record, "File (.mcap) for the frames of this run, a bag that runs again");
  command
      .add_flag("--redact", request.redact,
                "Black out people, by their boxes, in every picture of the run: report, frames, "
                "video, Foxglove, window, page (docs/privacy.md)")
      ->excludes(record);
  command.add_flag("--dump-map", request.dump_map, "Also write the map as text");
  add_quiet(command, request.quiet);
  command.add_flag("--json", request.json,
                   "Print the summary as JSON, and nothing else, on standard output");
}

/// Empty when the name is that of a picture that can be written, else why not.
std::string is_picture_name(const std::string& name) {
  return name.ends_with(".png") || name.ends_with(".jpg") ? "" : "must end in .png or .jpg";
}

void add_view_options(CLI::App& command, ViewRequest& view) {
  CLI::Option* window =
      command.add_flag("--view", view.window, "Watch in a window (docs/live-view.md)");
  command.add_flag("--view-close-at-end", view.close_at_end, "Close the window when the run ends")
      ->needs(window);
  command
      .add_option("--view-screenshot", view.screenshot,
                  "File (.png or .jpg): the window as it is when the run has ended")
      ->check(CLI::Validator(is_picture_name, "FILE.png or FILE.jpg"))
      ->needs(window);
  command.add_flag("--view-paused", view.paused, "Pause after the first frame")->needs(window);
  command.add_flag("--view-dense", view.dense, "Show the dense static cloud from the start")
      ->needs(window);
  command
      .add_option("--view-fps", view.most_redraws_hz,
                  "Most redraws in a second (software OpenGL: fewer leave more to tracking)")
      ->check(CLI::Range(1.0, 240.0))
      ->needs(window);
}

void add_serve_options(CLI::App& command, RunRequest& request) {
  CLI::Option* serve =
      command
          .add_option_function<std::string>(
              "--serve", [&request](const std::string& address) { request.serve = address; },
              "Watch in a browser, at ADDR:PORT (127.0.0.1:8090 unless named; docs/viewing.md)")
          ->expected(0, 1)
          ->default_str("");
  command
      .add_option("--serve-token", request.serve_token,
                  "What the browser must know; needed where others can reach the address")
      ->needs(serve);
}

void tell(const RunRequest& request, const RunOutcome& outcome) {
  if (request.json) {
    fmt::print("{}", outcome.summary_json);
    return;
  }
  if (request.quiet) return;
  fmt::print("tracked {} of {} frames\n", outcome.tracked, outcome.processed);
  fmt::print("results in {}\n", outcome.folder.string());
  if (outcome.groundtruth_file) {
    fmt::print("compare: ydd-slam eval {} {}\n", outcome.groundtruth_file->string(),
               (outcome.folder / "trajectory.tum").string());
  }
}

Result<void> run_and_tell(const RunRequest& request) {
  const Result<RunOutcome> outcome = run_sequence(request);
  if (!outcome) return outcome.error();
  tell(request, *outcome);
  const bool cut_short = !outcome->incomplete.empty();
  if (outcome->failure.empty()) {
    if (cut_short) {
      log::warning("{}; what was done until then is in {}", outcome->incomplete,
                   outcome->folder.string());
    }
    if (!cut_short) interruption::forgive();  // it came while the last results were written
    return {};
  }
  if (!cut_short) return Error{outcome->failure};
  return Error{fmt::format("{}; what was done until then is in {}", outcome->failure,
                           outcome->folder.string())};
}

}  // namespace

void add_run_command(CLI::App& app, Job& job) {
  auto request = std::make_shared<RunRequest>();
  auto* command = app.add_subcommand("run", "Track the camera through an RGB-D sequence");
  add_input_options(*command, *request);
  add_method_options(*command, *request);
  add_map_options(*command, *request);
  add_result_options(*command, *request);
  add_view_options(*command, request->view);
  add_serve_options(*command, *request);
  command->footer(
      "Recordings (--source NAME):\n" + source_table() +
      "Examples:\n"
      "  ydd-slam run rgbd_dataset_freiburg1_xyz\n"
      "  ydd-slam run my_recording --camera my_camera.yaml --out results\n"
      "  ydd-slam run my_recording --realtime --detect asynchronous\n"
      "  ydd-slam run my_recording --detector configs/detector/coco_body_head_hand.yaml\n"
      "  ydd-slam run my_recording --detector none\n"
      "  ydd-slam run openni2 --record walk.mcap --view\n"
      "  ydd-slam run samples/office_crowd --view\n"
      "  ydd-slam run samples/office_crowd --realtime --serve\n"
      "  ydd-slam run samples/office_crowd --detections samples/office_crowd/detections.jsonl \\\n"
      "      --video office.mp4\n"
      "  ydd-slam run monday --save-map office.map\n"
      "  ydd-slam run tuesday --map office.map --save-map office.map\n"
      "  ydd-slam run wednesday --map office.map --localization-only");
  command->callback(
      [request, &job] { job = [request]() -> Result<void> { return run_and_tell(*request); }; });
}

}  // namespace ydd::app
