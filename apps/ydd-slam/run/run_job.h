// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/dataset/sequence.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/map/atlas.h"

namespace ydd::app {

/// The window of a run, as the command line asks for it.
struct ViewRequest {
  bool window = false;
  bool close_at_end = false;
  bool dense = false;
  bool paused = false;  ///< after the first frame
  double most_redraws_hz = 30;
  std::string screenshot;  ///< of the window in the end, .png or .jpg; empty: none
};

/// One run as the command line asks for it.
struct RunRequest {
  std::string sequence;
  std::string camera;
  std::string config;
  std::vector<std::string> set;
  std::string out;
  std::string imu, odometry;  ///< files or topics of sensors of motion, or "off"
  std::string detections;     ///< recording to replay
  std::string detector;       ///< detector file, for looking at the frames themselves; empty: the
                              ///< default one unless boxes are replayed or nothing is rejected
  std::vector<std::string> detector_set;
  std::string detect;              ///< every-frame or asynchronous; empty: as configured
  std::string objects;             ///< object catalogue; empty: the built-in one
  std::string pictures;            ///< folder for annotated frames; empty: none
  std::string video;               ///< file for a video of annotated frames; empty: none
  std::string map;                 ///< file to go on with; empty: none
  std::string save_map;            ///< file to save to; empty: none
  std::string map_key;             ///< file with the key of both; empty: what the environment says
  bool replace_map = false;        ///< even by a lesser map
  bool localization_only = false;  ///< use the map, do not change it
  bool redact = false;             ///< no people in any picture that the run writes or shows
  std::string dynamic;
  std::string trajectory_format = "tum";
  std::optional<double> max_difference_s;  ///< where given, these count more than the
  std::optional<int> first_frame;          ///< configuration's
  std::optional<int> max_frames;
  std::optional<std::string> associations;
  std::optional<std::string> depth_offset, depth_shift;
  std::optional<std::string> source;
  std::optional<std::string> camera_mode;  ///< of a camera that is looked through
  std::string mcap;                        ///< file for Foxglove; empty: none
  std::string record;                      ///< bag to write what comes to; empty: none
  std::optional<std::string> topic_colour, topic_depth, topic_camera_info;  ///< of a bag
  ViewRequest view;
  std::optional<std::string> serve;  ///< address of the live page; empty: the default one
  std::string serve_token;
  int pictures_every = 1;
  int seed = -1;  ///< negative: as configured
  bool realtime = false;
  bool deterministic = false;
  bool strict = false;
  bool dump_map = false;
  bool quiet = false;
  bool json = false;
};

struct RunOutcome {
  std::filesystem::path folder;
  std::string summary_json;
  std::string timings_json;
  StampedPoses trajectory;
  std::optional<std::filesystem::path> groundtruth_file;  ///< in TUM's format
  std::shared_ptr<const Atlas> atlas;                     ///< in the end
  int processed = 0;
  int tracked = 0;
  std::string incomplete = {};  ///< why the run ended before its sequence did; empty: it did not
  std::string failure = {};     ///< one line on what went wrong, or could not be written
};

/// Runs the system over a sequence and leaves the results in a folder.
///
/// Fails when nothing could be computed: an input that cannot be read. Once a frame has been
/// processed there is an outcome, whatever happens then: what was done is written, each result on
/// its own, and `incomplete` and `failure` tell what is missing.
Result<RunOutcome> run_sequence(const RunRequest& request);

/// The same for those who need all of it: fails also when it ended early or something went wrong.
Result<RunOutcome> run_whole_sequence(const RunRequest& request);

}  // namespace ydd::app
