// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "commands.h"
#include "common/progress.h"
#include "common/terminal.h"
#include "ydd/simulation/tum_writer.h"

namespace ydd::app {
namespace {

struct SimulateRequest {
  std::string out;
  std::string config;
  std::vector<std::string> set;
  std::vector<std::string> shortcuts;  ///< "key=value" from --path, --people, ...
  std::string colour_format = "png";
  int jpeg_quality = 92;
  int jobs = 0;
  bool busy = false;
  bool quiet = false;
};

Result<void> simulate(const SimulateRequest& request) {
  WorldOptions world;
  OptionTable table;
  world.describe(table);
  if (!request.config.empty()) {
    if (auto r = table.load_yaml(request.config); !r) return r;
  }
  for (const std::string& assignment : request.set) {
    if (auto r = table.set_assignment(assignment, "--set"); !r) return r;
  }
  for (const std::string& assignment : request.shortcuts) {
    const std::string source = "--" + assignment.substr(0, assignment.find('='));
    if (auto r = table.set_assignment(assignment, source); !r) return r;
  }
  if (request.busy) world.busy = true;
  const Simulator simulator(world);
  Progress progress(request.out, static_cast<std::size_t>(simulator.frame_count()), request.quiet);
  TumWriterOptions options;
  options.colour_format = parse_choice<ColourFormat>(request.colour_format).value();
  options.jpeg_quality = request.jpeg_quality;
  options.jobs = request.jobs;
  options.about = table.to_yaml();
  options.progress = [&](int done) { progress.update(static_cast<std::size_t>(done), ""); };
  if (auto r = write_tum_sequence(simulator, request.out, options); !r) return r;
  fmt::print("{} frames in {}\n", simulator.frame_count(), request.out);
  return {};
}

/// `--name VALUE` as another way to write `--set name=VALUE`.
void add_shortcut(CLI::App& command, const std::shared_ptr<SimulateRequest>& request,
                  const std::string& name, const std::string& sentence) {
  command
      .add_option_function<std::string>(
          "--" + name,
          [request, name](const std::string& value) {
            request->shortcuts.push_back(name + "=" + value);
          },
          sentence)
      ->type_name("VALUE");
}

}  // namespace

void add_simulate_command(CLI::App& app, Job& job) {
  auto request = std::make_shared<SimulateRequest>();
  auto* command = app.add_subcommand("simulate", "Render a sequence with exact ground truth");
  command->add_option("out", request->out, "Folder to make, in the TUM RGB-D layout")->required();
  add_shortcut(*command, request, "path", "static, xyz, rpy, halfsphere or room_loop");
  add_shortcut(*command, request, "people", "How many people walk and sit about");
  command->add_flag("--busy", request->busy, "People close to the camera, half the picture");
  add_shortcut(*command, request, "mover", "none, cabinet, curtain, door, robot or screen");
  add_shortcut(*command, request, "light", "steady, day, evening, lamps or changing");
  add_shortcut(*command, request, "frames", "Length (default: one round of the path)");
  add_shortcut(*command, request, "seed", "Everything random follows from it");
  add_shortcut(*command, request, "depth", "exact or kinect");
  command->add_option("--set", request->set, "Set any option of the world: key=value")
      ->allow_extra_args(false);
  command->add_option("--config", request->config, "YAML file with options of the world");
  command->add_option("--colour-format", request->colour_format, "png or jpeg")
      ->check(CLI::IsMember({"png", "jpeg"}))
      ->capture_default_str();
  command->add_option("--jpeg-quality", request->jpeg_quality, "Quality of JPEG files")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--jobs", request->jobs, "Frames rendered at the same time; 0: all cores")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  add_quiet(*command, request->quiet);
  command->footer(
      "Command line beats file beats default; the options used are kept as simulation.yaml.\n"
      "Examples:\n"
      "  ydd-slam simulate room --path room_loop\n"
      "  ydd-slam simulate busy --busy --path xyz --depth kinect --seed 3\n"
      "  ydd-slam simulate dusk --path room_loop --light evening --set light_seed=5\n"
      "  ydd-slam simulate small --frames 60 --set width=320 --set height=240\n"
      "  ydd-slam run busy --detections busy/detections.jsonl --dynamic full");
  command->callback([request, &job] { job = [request] { return simulate(*request); }; });
}

}  // namespace ydd::app
