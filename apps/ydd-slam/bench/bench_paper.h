// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/paper/paper_sequences.h"
#include "ydd/paper/run_figures.h"

namespace ydd::app {

/// What --detector takes for "the boxes recorded beside each sequence".
inline constexpr const char* kRecordedBoxes = "recorded";

/// The network alone, as a variant.
inline constexpr const char* kNetworkAlone = "network";

struct PaperRequest {
  std::string data;
  std::string out = "paper";  ///< folder for everything
  int runs = 5;
  std::vector<std::string> variants{"off", "box", "person", "full", "evidence"};
  std::string detector;  ///< empty: the program's own; `none`; `recorded`; or a file
  std::vector<std::string> detector_set, set;
  std::vector<std::string> own;  ///< NAME=FOLDER: recordings of the user's
  std::string systems;           ///< folder of other systems' trajectories
  bool realtime = false;
  bool fresh = false;  ///< runs that are there are made again
  // For an engine that spreads the runs over machines (bench/workflow):
  bool plan = false;             ///< name the runs, make none
  std::vector<std::string> one;  ///< SEQUENCE VARIANT NUMBER: make this run, write no pages
  bool gather = false;           ///< make no run, write the pages of those that are there
};

/// One run to make.
struct PaperRun {
  PaperSequence sequence;
  std::string variant;
  int run = 1;
};

/// What a run depends on besides its sequence, variant and number, as one line of text: figures of
/// other settings are not used again.
std::string paper_settings(const PaperRequest& request, const PaperSequence& sequence);

/// Where the figures of a run lie.
std::filesystem::path figures_file(const PaperRequest& request, const PaperRun& run);

/// Makes a run in a process of its own and scores it. `scratch` is a folder for it, which goes.
Result<RunFigures> make_paper_run(const PaperRequest& request, const PaperRun& run,
                                  const std::filesystem::path& scratch);

/// Scores the trajectories below `folder`: `SYSTEM/FILE`, where the file's name tells the sequence
/// as a folder's would, several files of one sequence are several runs. `remarks` gets a line for
/// each that could not be used. `variant` of what comes back names the system.
std::vector<RunFigures> score_systems(const std::filesystem::path& folder,
                                      const std::vector<PaperSequence>& sequences,
                                      std::vector<std::string>& remarks);

/// The article's tables and figures with ours beside them, from a folder of recordings: makes the
/// runs that are not there yet and writes paper.html, paper.json and paper.tex. Gives what to
/// print. Failure: nothing to measure on, files that cannot be written, runs that failed (the pages
/// are written all the same), or being asked to end.
Result<std::string> bench_paper(const PaperRequest& request);

}  // namespace ydd::app
