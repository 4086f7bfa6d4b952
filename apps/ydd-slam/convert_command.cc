// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "commands.h"
#include "common/progress.h"
#include "common/terminal.h"
#include "ydd/base/files.h"
#include "ydd/base/fresh_folder.h"
#include "ydd/base/interruption.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/image/encode.h"
#include "ydd/sources/source.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

struct ConvertRequest {
  std::string from;
  std::string to;
  std::string camera;
  SequenceOptions options;
  bool quiet = false;
};

/// The texts of the folder, as they grow.
struct Lists {
  std::string colour = "# timestamp filename\n";
  std::string depth = "# timestamp filename\n";
  int frames = 0;
  double depth_scale = 0;  ///< counts of a metre in the pictures written
};

/// A frame as two files; counts stay as they are, metres become millimetres.
Result<void> write_frame(const Sequence& sequence, std::size_t i, const Camera& camera,
                         const fs::path& folder, Lists& lists) {
  const SequenceEntry& entry = sequence.entry(i);
  const PictureStore& pictures = *sequence.recording().pictures;
  const Result<ColourImage> colour = sequence.read_colour(i);
  if (!colour) return colour.error();
  const Result<DepthPicture> picture = pictures.depth(entry.depth);
  if (!picture) return picture.error();
  const Result<RawDepthImage> depth = picture->counts();
  if (!depth) return depth.error();
  // Pairs share a name, also where a depth picture belongs to several colour pictures.
  const std::string stamp = format_timestamp(entry.stamp);
  const std::string colour_name = "rgb/" + stamp + ".png", depth_name = "depth/" + stamp + ".png";
  if (auto r = write_png(folder / colour_name, *colour); !r) return r;
  if (auto r = write_png(folder / depth_name, *depth); !r) return r;
  lists.colour += stamp + " " + colour_name + "\n";
  lists.depth += stamp + " " + depth_name + "\n";
  lists.depth_scale = picture->is_metric ? 1000 : camera.depth_scale;
  ++lists.frames;
  return {};
}

Result<void> write_texts(const Sequence& sequence, Camera camera, const fs::path& folder,
                         const Lists& lists) {
  camera.depth_scale = lists.depth_scale;
  OptionTable table;
  camera.describe(table);
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"rgb.txt", lists.colour},
                                   {"depth.txt", lists.depth},
                                   {"camera.yaml", table.to_yaml()}}) {
    if (auto r = write_file_atomically(folder / name, text); !r) return r;
  }
  if (!sequence.groundtruth()) return {};
  const Result<StampedPoses> truth = sequence.groundtruth()->read();
  if (!truth) {
    log::warning("{}; no ground truth", truth.error().message);
    return {};
  }
  return write_trajectory(folder / "groundtruth.txt", *truth);
}

Result<int> write_folder(const Sequence& sequence, const Camera& camera, const fs::path& folder,
                         bool quiet) {
  std::error_code failure;
  for (const char* const part : {"rgb", "depth"}) {
    fs::create_directories(folder / part, failure);
    if (failure) {
      return Error{fmt::format("{}: cannot be created: {}", folder.string(), failure.message())};
    }
  }
  Lists lists;
  Progress progress(sequence.name(), sequence.size(), quiet);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    interruption::throw_if_asked();
    if (auto r = write_frame(sequence, i, camera, folder, lists); !r) {
      // A picture that cannot be read is the recording's fault, all others are ours.
      const bool ours = r.error().message.starts_with(folder.string());
      if (ours) return r.error();
      log::warning("frame {}: {}; left out", i, r.error().message);
    }
    progress.update(i + 1, "");
  }
  if (lists.frames == 0) {
    return Error{fmt::format("{}: not one frame could be read", sequence.place().string())};
  }
  if (auto r = write_texts(sequence, camera, folder, lists); !r) return r.error();
  return lists.frames;
}

Result<void> convert(const ConvertRequest& request) {
  const fs::path to = request.to;
  if (fs::exists(to)) {
    return Error{fmt::format("{}: exists already; remove it or name another folder", to.string())};
  }
  const Result<Sequence> sequence = open_sequence(request.from, request.options);
  if (!sequence) return sequence.error();
  const Result<Camera> camera = find_camera(sequence->recording(), request.camera);
  if (!camera) return camera.error();
  const FreshFolder fresh(to);
  const Result<int> frames = write_folder(*sequence, *camera, fresh.path(), request.quiet);
  if (!frames) return frames.error();
  if (auto r = fresh.place(); !r) return r;
  if (!request.quiet) fmt::print("{} frames in {}\n", *frames, to.string());
  return {};
}

}  // namespace

void add_convert_command(CLI::App& app, Job& job) {
  auto request = std::make_shared<ConvertRequest>();
  SequenceOptions& options = request->options;
  auto* command =
      app.add_subcommand("convert", "Write a recording as a folder in the TUM RGB-D layout");
  command->add_option("recording", request->from, "Recording: a folder or file")->required();
  command->add_option("folder", request->to, "Folder to make")->required();
  command->add_option("--source", options.source, "What the recording is (default: as it looks)")
      ->check(CLI::IsMember(source_names()));
  command->add_option("--topic-colour,--topic-color", options.topic_colour, "Topic of a bag");
  command->add_option("--topic-depth", options.topic_depth, "The same of depth");
  command->add_option("--topic-camera-info", options.topic_camera_info, "The same of the camera");
  command->add_option("--camera", request->camera, "Camera file or preset");
  command->add_option("--max-difference", options.max_difference_s,
                      "Largest time between paired images in seconds");
  command->add_option("--depth-offset", options.depth_offset,
                      "Seconds to add to the stamps of depth images, or auto");
  command->add_option("--start-frame", options.first_frame, "Leave out so many at the beginning")
      ->check(CLI::Range(0, 1000000000));
  command->add_option("--max-frames", options.max_frames, "Stop after so many frames (0: all)")
      ->check(CLI::Range(0, 1000000000));
  add_quiet(*command, request->quiet);
  command->footer(
      "Colour as PNG, depth as it is counted (metres: in millimetres), camera.yaml, truth.\n"
      "Recordings (--source NAME):\n" +
      source_table() +
      "Examples:\n"
      "  ydd-slam convert walk.bag walk\n"
      "  ydd-slam convert chess/seq-01 chess_01 --max-frames 200");
  command->callback([request, &job] { job = [request] { return convert(*request); }; });
}

}  // namespace ydd::app
