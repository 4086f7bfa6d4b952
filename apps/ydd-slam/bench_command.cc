// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/bench_paper.h"
#include "bench/bench_scale.h"
#include "bench/bench_seeds.h"
#include "bench/bench_sessions.h"
#include "commands.h"
#include "common/scratch_folder.h"
#include "common/terminal.h"
#include "ydd/studies/accidents.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

using Bench = Result<std::string> (*)(const BenchRequest&, const fs::path&);

/// Runs a bench with a scratch folder that goes afterwards.
Result<void> run_bench(Bench bench, const BenchRequest& request) {
  const Result<ScratchFolder> scratch = ScratchFolder::make();
  if (!scratch) return scratch.error();
  const Result<std::string> table = bench(request, scratch->path());
  if (!table) return table.error();
  fmt::print("{}", *table);
  return {};
}

void add_bench(CLI::App& parent, Job& job, const std::string& name, const std::string& what,
               Bench bench, bool boxes_needed) {
  auto request = std::make_shared<BenchRequest>();
  request->boxes_needed = boxes_needed;
  auto* command = parent.add_subcommand(name, what);
  command->add_option("sequences", request->sequences, "Recordings (run --help lists their kinds)");
  command->add_option("--simulated", request->simulated, "Also so many simulated busy rooms");
  command->add_option("--simulated-frames", request->simulated_frames, "Length of these");
  command->add_option("--detector", request->detector,
                      "Detector YAML; default: boxes recorded beside the sequence "
                      "(detections.jsonl, detections_gt.jsonl); none: no boxes");
  command->add_option("--detector-set", request->detector_set, "Set one detector option: key=value")
      ->allow_extra_args(false);
  command->add_option("--runs", request->runs, "Runs per figure (the median is given)")
      ->check(CLI::Range(1, 100));
  command->add_option("--set", request->set, "Set one option: key=value")->allow_extra_args(false);
  if (bench == &bench_speed) {
    command->add_option("--detect", request->detect, "every-frame or asynchronous");
    command
        ->add_option("--against", request->against,
                     "Compare in pairs with a configuration B that also sets key=value")
        ->allow_extra_args(false);
  }
  command->add_option("--out", request->out, "Also write all figures as JSON");
  command->callback([request, bench, &job] {
    job = [request, bench]() -> Result<void> {
      if (request->sequences.empty() && request->simulated == 0) {
        return Error{"bench: name a sequence or give --simulated N"};
      }
      return run_bench(bench, *request);
    };
  });
}

using SeedBench = Result<std::string> (*)(const SeedRequest&);

void add_seed_bench(CLI::App& parent, Job& job, const std::string& name, const std::string& what,
                    SeedBench bench) {
  auto request = std::make_shared<SeedRequest>();
  auto* command = parent.add_subcommand(name, what);
  if (bench == &bench_places) {
    command->add_option("sequences", request->sequences, "Recordings with ground truth to add");
    command->add_option("--apart", request->apart_s, "Seconds between two looks at a place")
        ->check(CLI::Range(0.5, 3600.0))
        ->capture_default_str();
  }
  const int fewest = bench == &bench_places ? 0 : 1;
  command->add_option("--seeds", request->seeds, "How many worlds")
      ->check(CLI::Range(fewest, 10000));
  command->add_option("--first-seed", request->first_seed, "Seed of the first")
      ->check(CLI::Range(0, 1000000));
  if (bench == &bench_recovery) {
    const auto names = choices_of(Senses{});
    command->add_option("--senses", request->senses, "Of motion, besides the camera")
        ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  }
  command->add_option("--only", request->only, "Worlds or accidents with this in their name");
  command->add_option("--width", request->width_px, "Width of the pictures in px, 4:3")
      ->check(CLI::Range(160, 1280));
  command->add_option("--fps", request->fps, "Frames a second")->check(CLI::Range(1.0, 60.0));
  command->add_option("--minutes", request->minutes, "Length of the walk")
      ->check(CLI::Range(0.1, 1000.0));
  command->add_option("--set", request->set, "Set one option: key=value")->allow_extra_args(false);
  command->add_option("--out", request->out, "Also write all figures as JSON");
  command->callback([request, bench, &job] {
    job = [request, bench]() -> Result<void> {
      const Result<std::string> table = bench(*request);
      if (!table) return table.error();
      fmt::print("{}", *table);
      return {};
    };
  });
}

void add_scale_bench(CLI::App& parent, Job& job) {
  auto request = std::make_shared<ScaleRequest>();
  auto* command = parent.add_subcommand(
      "scale", "Maps grown from simulated rooms: what a frame, a keyframe, a save cost by size");
  command->add_option("--keyframes", request->sizes, "Sizes of the maps")
      ->delimiter(',')
      ->check(CLI::Range(100, 1000000))
      ->capture_default_str();
  command->add_option("--keypoints", request->keypoints, "Points of a keyframe, about")
      ->check(CLI::Range(100, 2000))
      ->capture_default_str();
  command->add_option("--rooms", request->rooms, "Different rooms that they are grown from")
      ->check(CLI::Range(1, 50));
  command->add_option("--seed", request->seed, "Of what makes copies of a room look different");
  command->add_option("--first-seed", request->first_seed, "Seed of the first room")
      ->check(CLI::Range(0, 1000000));
  command->add_option("--width", request->width_px, "Width of the pictures in px, 4:3")
      ->check(CLI::Range(160, 1280));
  command->add_option("--fps", request->fps, "Frames a second")->check(CLI::Range(1.0, 60.0));
  command->add_option("--set", request->set, "Set one option: key=value")->allow_extra_args(false);
  command->add_option("--out", request->out, "Also write all figures as JSON");
  command->callback([request, &job] {
    job = [request]() -> Result<void> {
      const Result<std::string> table = bench_scale(*request);
      if (!table) return table.error();
      fmt::print("{}", *table);
      return {};
    };
  });
}

using SessionBench = Result<std::string> (*)(const SessionRequest&);

/// Gives the command and what it will ask for, to add options to.
std::pair<CLI::App*, std::shared_ptr<SessionRequest>> add_session_bench(CLI::App& parent, Job& job,
                                                                        const std::string& name,
                                                                        const std::string& what,
                                                                        SessionBench bench) {
  auto request = std::make_shared<SessionRequest>();
  auto* command = parent.add_subcommand(name, what);
  command->add_option("--seed", request->seed, "Of the world")->check(CLI::Range(0, 1000000));
  command->add_option("--width", request->width_px, "Width of the pictures in px, 4:3")
      ->check(CLI::Range(160, 1280));
  command->add_option("--fps", request->fps, "Frames a second")->check(CLI::Range(1.0, 60.0));
  command->add_flag("--steady", request->steady, "Light that does not change");
  command->add_option("--folder", request->folder,
                      "Keep map and figures there; a second call goes on where it ended");
  command->add_option("--set", request->set, "Set one option: key=value")->allow_extra_args(false);
  command->add_option("--out", request->out, "Also write all figures as JSON");
  add_quiet(*command, request->quiet);
  command->callback([request, bench, &job] {
    job = [request, bench]() -> Result<void> {
      const Result<std::string> table = bench(*request);
      if (!table) return table.error();
      fmt::print("{}", *table);
      return {};
    };
  });
  return {command, request};
}

void add_session_benches(CLI::App& parent, Job& job) {
  const auto [visits, visit_request] =
      add_session_bench(parent, job, "visits",
                        "One room, visited again and again in changing light: does the map stay "
                        "small?",
                        &bench_visits);
  visits->add_option("--visits", visit_request->sessions, "How many")->check(CLI::Range(1, 100000));
  visits->add_option("--seconds", visit_request->seconds, "Of each visit but the first")
      ->check(CLI::Range(1.0, 3600.0));
  const auto [days, day_request] = add_session_bench(
      parent, job, "days", "Hours through a building with people, moved furniture, changing light",
      &bench_days);
  day_request->sessions = 8;
  days->add_option("--hours", day_request->sessions, "How many")->check(CLI::Range(1, 100000));
  days->add_option("--minutes", day_request->minutes, "Of each hour")
      ->check(CLI::Range(0.1, 1000.0));
  days->add_option("--rooms", day_request->rooms, "Of the building")->check(CLI::Range(1, 20));
  days->add_option("--people", day_request->people, "In its first room")->check(CLI::Range(0, 12));
}

void add_paper_bench(CLI::App& parent, Job& job) {
  auto request = std::make_shared<PaperRequest>();
  auto* command = parent.add_subcommand(
      "paper",
      "The article's tables and figures with ours beside them, from TUM's and Bonn's data");
  command->add_option("data", request->data, "Folder below which the sequences lie")->required();
  command
      ->add_option("--out", request->out, "Folder for runs and pages; a second call goes on there")
      ->capture_default_str();
  command->add_option("--runs", request->runs, "Runs of each variant on each sequence")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  const auto names = choices_of(Variant{});
  command->add_option("--variants", request->variants, "Which variants (default: all)")
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  command->add_option("--detector", request->detector,
                      "Detector file; none; recorded: boxes beside each sequence (default: the "
                      "network of the program)");
  command->add_option("--detector-set", request->detector_set, "Set one detector option: key=value")
      ->allow_extra_args(false);
  command->add_option("--set", request->set, "Set one option: key=value")->allow_extra_args(false);
  command
      ->add_option("--own", request->own,
                   "NAME=FOLDER: a recording of your own; the article has linear and annular")
      ->allow_extra_args(false);
  command
      ->add_option("--systems", request->systems,
                   "Trajectories of other systems: SYSTEM/SEQUENCE.txt below this folder, TUM's "
                   "format")
      ->check(CLI::ExistingDirectory);
  command->add_flag("--realtime", request->realtime, "At the camera's pace");
  command->add_flag("--fresh", request->fresh, "Make runs again that are there");
  command->add_flag("--plan", request->plan,
                    "Only name the runs: SEQUENCE VARIANT NUMBER, and there or missing");
  command
      ->add_option("--one", request->one,
                   "Only make this run, SEQUENCE VARIANT NUMBER, and write no pages")
      ->expected(3);
  command->add_flag("--gather", request->gather, "Make no run, write the pages of those there");
  command->callback([request, &job] {
    job = [request]() -> Result<void> {
      const Result<std::string> said = bench_paper(*request);
      if (!said) return said.error();
      fmt::print("{}", *said);
      return {};
    };
  });
}

}  // namespace

void add_bench_command(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("bench", "Measure accuracy, point decisions and speed");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  ydd-slam bench ablation samples/office_crowd --simulated 3\n"
      "  ydd-slam bench dynamics samples/office_crowd\n"
      "  ydd-slam bench detection samples/office_crowd --runs 3\n"
      "  ydd-slam bench speed rgbd_dataset_freiburg1_xyz --against loop.enabled=false\n"
      "  ydd-slam bench loops --seeds 20\n"
      "  ydd-slam bench scale --keyframes 1000,10000\n"
      "  ydd-slam bench paper datasets --out paper");
  add_bench(*command, job, "ablation",
            "ATE and RPE of the variants off, box, person, full, evidence", &bench_ablation, true);
  add_bench(*command, job, "dynamics", "Recall and precision of rejected points per variant",
            &bench_dynamics, true);
  add_bench(*command, job, "detection",
            "What asynchronous detection costs: ATE and point decisions by latency",
            &bench_detection, true);
  add_bench(*command, job, "boxes", "What faults of a detector cost: ATE by kind of fault",
            &bench_boxes, true);
  add_bench(*command, job, "speed", "Time per frame and stage", &bench_speed, false);
  add_seed_bench(*command, job, "loops",
                 "Simulated walks: loops closed, false ones, what they gain", &bench_loops);
  add_seed_bench(*command, job, "places", "Simulated walks: how often a place is recognised",
                 &bench_places);
  add_seed_bench(*command, job, "recovery",
                 "Simulated accidents: how often and how soon a lost camera is found again",
                 &bench_recovery);
  add_seed_bench(*command, job, "motion",
                 "Worlds of points: how soon movers are found, and false alarms", &bench_motion);
  add_seed_bench(*command, job, "tracks",
                 "Simulated people: how well their tracks tell where they are and go",
                 &bench_tracks);
  add_paper_bench(*command, job);
  add_seed_bench(*command, job, "walk", "One long simulated walk: time, memory and map size",
                 &bench_walk);
  add_scale_bench(*command, job);
  add_session_benches(*command, job);
}

}  // namespace ydd::app
