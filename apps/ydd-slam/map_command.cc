// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "commands.h"
#include "common/terminal.h"
#include "map/map_jobs.h"

namespace ydd::app {
namespace {

void add_info(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapInfoRequest>();
  auto* command = parent.add_subcommand("info", "Say what is inside a map file");
  command->add_option("file", request->file, "Map file")->required();
  command->add_flag("--json", request->json, "As JSON");
  add_map_key(*command, request->map_key);
  command->callback([request, &job] { job = [request] { return map_info(*request); }; });
}

void add_grid_options(CLI::App& command, MapExportRequest& request) {
  CLI::Option* grid =
      command
          .add_option("--grid", request.grid,
                      "PGM file for the floor as a robot needs it (map_server); its YAML is "
                      "written beside it")
          ->check(CLI::Validator(
              [](const std::string& name) {
                return name.ends_with(".pgm") ? std::string() : std::string("must end in .pgm");
              },
              "FILE.pgm"));
  GridOptions& options = request.grid_options;
  command.add_option("--grid-resolution", options.resolution_m, "Edge of a cell, metres")
      ->check(CLI::Range(0.005, 10.0))
      ->needs(grid)
      ->capture_default_str();
  command
      .add_option("--min-height", options.min_height_m,
                  "What is lower above the floor is no obstacle, metres")
      ->check(CLI::Range(0.01, 10.0))
      ->needs(grid)
      ->capture_default_str();
  command.add_option("--max-height", options.max_height_m, "What is higher is none either, metres")
      ->check(CLI::Range(0.02, 20.0))
      ->needs(grid)
      ->capture_default_str();
}

void add_export(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapExportRequest>();
  auto* command = parent.add_subcommand("export", "Clouds and poses out of a map file");
  command->add_option("file", request->file, "Map file")->required();
  command->add_option("--sparse", request->sparse, "PLY file for the points it tracks by");
  command->add_option("--dense", request->dense,
                      "PLY file for a coloured cloud of what keyframes saw, without what moved");
  command->add_option("--voxel", request->cloud.voxel_m, "Edge of the dense cloud's cubes, metres")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  command
      ->add_option("--max-depth", request->cloud.max_depth_m,
                   "Depth readings beyond are left out, metres")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  command->add_flag("--redact", request->cloud.redact,
                    "No colour from pictures that may show people (docs/privacy.md)");
  command->add_option("--keyframes", request->keyframes, "TUM file for the poses of keyframes");
  command->add_option("--octomap", request->octomap,
                      "OctoMap file (.bt) with what is occupied and what is free");
  command
      ->add_option("--octomap-resolution", request->octomap_resolution_m,
                   "Edge of its smallest cubes, metres")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  add_grid_options(*command, *request);
  command->add_option("--which", request->which,
                      "Number of the map, when the file holds several (default: the largest)");
  add_map_key(*command, request->map_key);
  command->callback([request, &job] {
    if (request->sparse.empty() && request->dense.empty() && request->keyframes.empty() &&
        request->octomap.empty() && request->grid.empty()) {
      throw CLI::RequiredError("One of --sparse, --dense, --keyframes, --octomap, --grid");
    }
    if (request->grid_options.min_height_m >= request->grid_options.max_height_m) {
      throw CLI::ValidationError("--min-height", "must be less than --max-height");
    }
    job = [request] { return map_export(*request); };
  });
}

void add_merge(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapMergeRequest>();
  auto* command = parent.add_subcommand(
      "merge", "Put map files into one, merged where they show the same place");
  command->add_option("files", request->files, "Map files; the world of the first stays")
      ->required()
      ->expected(2, 1000);
  command->add_option("--out", request->out, "Map file to write")->required();
  command->add_flag("--replace-map", request->replace_map,
                    "Let it replace a map that holds more than the new one");
  command->add_option("--config", request->config, "YAML file with options (loop, mapping)");
  command->add_option("--set", request->set, "Set one option: key=value")->allow_extra_args(false);
  add_map_key(*command, request->map_key);
  command->callback([request, &job] { job = [request] { return map_merge(*request); }; });
}

void add_check(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapCheckRequest>();
  auto* command = parent.add_subcommand(
      "check", "Look whether a map file is sound; repairs nothing, exit 1 if it is not");
  command->add_option("file", request->file, "Map file")->required();
  add_map_key(*command, request->map_key);
  command->callback([request, &job] { job = [request] { return map_check(*request); }; });
}

void add_prune(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapPruneRequest>();
  auto* command = parent.add_subcommand("prune", "A map without what was never seen again");
  command->add_option("file", request->file, "Map file")->required();
  command->add_option("--out", request->out, "Map file to write")->required();
  command
      ->add_option("--min-keyframes", request->options.min_keyframes,
                   "Maps with fewer keyframes go; the largest stays")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  command
      ->add_option("--min-observations", request->options.min_observations,
                   "Points that fewer keyframes see go")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command
      ->add_option("--min-points", request->options.min_points,
                   "Keyframes that then see fewer points go")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->add_flag("--replace-map", request->replace_map,
                    "Let it replace a map that holds more than the new one");
  add_map_key(*command, request->map_key);
  command->callback([request, &job] { job = [request] { return map_prune(*request); }; });
}

void add_split(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapSplitRequest>();
  auto* command = parent.add_subcommand("split", "Some maps of a file into a file of their own");
  command->add_option("file", request->file, "Map file")->required();
  command->add_option("--which", request->which, "Numbers of the maps ('map info' lists them)")
      ->required()
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out", request->out, "Map file to write")->required();
  command->add_flag("--replace-map", request->replace_map,
                    "Let it replace a map that holds more than the new one");
  add_map_key(*command, request->map_key);
  command->callback([request, &job] { job = [request] { return map_split(*request); }; });
}

void add_encrypt(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapConvertRequest>();
  auto* command = parent.add_subcommand(
      "encrypt", "Encrypt a plain map file by --map-key, or give an encrypted one another key");
  command->add_option("file", request->file, "Map file")->required();
  command->add_option("--out", request->out, "Map file to write (default: the same file)");
  command->add_option("--old-key", request->old_key,
                      "File with the key that it is encrypted by now");
  add_map_key(*command, request->map_key);
  command->callback([request, &job] { job = [request] { return map_encrypt(*request); }; });
}

void add_decrypt(CLI::App& parent, Job& job) {
  auto request = std::make_shared<MapConvertRequest>();
  auto* command =
      parent.add_subcommand("decrypt", "Make a plain map file of one that --map-key encrypts");
  command->add_option("file", request->file, "Map file")->required();
  command->add_option("--out", request->out, "Map file to write (default: the same file)");
  add_map_key(*command, request->map_key);
  command->callback([request, &job] { job = [request] { return map_decrypt(*request); }; });
}

}  // namespace

void add_map_command(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "map", "Look into map files, export, merge, check, prune, split and encrypt them");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  ydd-slam run monday --save-map office.map\n"
      "  ydd-slam map info office.map\n"
      "  ydd-slam map export office.map --dense office.ply --voxel 0.02\n"
      "  ydd-slam map export office.map --sparse points.ply --keyframes keyframes.tum\n"
      "  ydd-slam map export office.map --octomap office.bt\n"
      "  ydd-slam map export office.map --grid office.pgm --max-height 1.2\n"
      "  ydd-slam map merge office.map corridor.map kitchen.map --out floor.map\n"
      "  ydd-slam map check floor.map\n"
      "  ydd-slam map prune floor.map --out small.map\n"
      "  ydd-slam map split floor.map --which 1 --out one.map\n"
      "  ydd-slam map encrypt floor.map --map-key office.key\n"
      "docs/maps.md tells the rest.");
  add_info(*command, job);
  add_export(*command, job);
  add_merge(*command, job);
  add_check(*command, job);
  add_prune(*command, job);
  add_split(*command, job);
  add_encrypt(*command, job);
  add_decrypt(*command, job);
}

}  // namespace ydd::app
