// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_paper.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/child_run.h"
#include "common/default_detector.h"
#include "common/scratch_folder.h"
#include "ydd/base/file_lock.h"
#include "ydd/base/files.h"
#include "ydd/base/interruption.h"
#include "ydd/base/json_text.h"
#include "ydd/base/log.h"
#include "ydd/base/version.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/paper/paper_report.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

/// What there is to run, and what to say about it.
struct PaperPlan {
  std::vector<PaperSequence> sequences;
  std::vector<PaperRun> runs;
  std::vector<std::string> remarks;
};

/// NAME=FOLDER, where the name can be that of a folder and is none of the data sets'.
Result<PaperSequence> own_sequence(const std::string& assignment) {
  const std::size_t at = assignment.find('=');
  const std::string name = assignment.substr(0, at);
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  if (at == std::string::npos || name.empty() || at + 1 == assignment.size() || !plain ||
      sequence_name(name)) {
    return Error{
        fmt::format("--own {}: must be NAME=FOLDER, the name of letters, digits, _ and - "
                    "and not that of a TUM or Bonn sequence",
                    assignment)};
  }
  return PaperSequence{name, assignment.substr(at + 1), true};
}

/// Public sequences below DATA and the user's own.
Result<PaperPlan> find_sequences(const PaperRequest& request) {
  Result<FoundSequences> found = find_paper_sequences(request.data);
  if (!found) return found.error();
  PaperPlan plan{std::move(found->sequences), {}, {}};
  for (const std::string& name : found->missing) {
    plan.remarks.push_back(
        fmt::format("{} is not below {}: its rows hold only the article's "
                    "figures (tools/get-datasets brings it)",
                    name, request.data));
  }
  for (const fs::path& folder : found->duplicates) {
    plan.remarks.push_back(
        fmt::format("{}: a second folder of its sequence, not used", folder.string()));
  }
  for (const std::string& assignment : request.own) {
    Result<PaperSequence> own = own_sequence(assignment);
    if (!own) return own.error();
    plan.sequences.push_back(*std::move(own));
  }
  if (request.own.empty()) {
    plan.remarks.emplace_back(
        "table 13 and figure 19 are about drives of a robot of the authors', "
        "which are not public: --own linear=FOLDER and --own annular=FOLDER "
        "take recordings of your own");
  }
  if (plan.sequences.empty()) {
    return Error{
        fmt::format("{}: no folder below it holds a sequence with a name like "
                    "rgbd_dataset_freiburg3_walking_xyz or rgbd_bonn_crowd",
                    request.data)};
  }
  return plan;
}

/// Every variant on every sequence once, then all of that again: what is cut short has something
/// of everything.
void plan_runs(const PaperRequest& request, PaperPlan& plan) {
  const bool blind = request.detector == kNoDetector;
  std::vector<std::string> variants;
  for (const std::string& variant : request.variants) {
    if (blind && needs_boxes(parse_choice<Variant>(variant).value())) continue;
    variants.push_back(variant);
  }
  if (blind) plan.remarks.emplace_back("without a detector only off and evidence are run");
  const bool looks = !blind && request.detector != kRecordedBoxes;
  for (int run = 1; run <= request.runs; ++run) {
    for (const PaperSequence& sequence : plan.sequences) {
      for (const std::string& variant : variants) plan.runs.push_back({sequence, variant, run});
      if (looks && run == 1) plan.runs.push_back({sequence, kNetworkAlone, run});
    }
  }
}

/// Figures of an earlier call; nothing where they are not there, damaged or of other settings.
std::optional<RunFigures> earlier_figures(const PaperRequest& request, const PaperRun& run) {
  const fs::path file = figures_file(request, run);
  if (request.fresh || !fs::exists(file)) return std::nullopt;
  const Result<std::string> text = read_file(file);
  Result<RunFigures> figures =
      text ? parse_run_figures(*text, file.string()) : Result<RunFigures>(text.error());
  if (!figures) {
    log::warning("{}; the run is made again", figures.error().message);
    return std::nullopt;
  }
  const bool same = figures->sequence == run.sequence.name && figures->variant == run.variant &&
                    figures->run == run.run &&
                    figures->settings == paper_settings(request, run.sequence);
  if (!same) {
    log::warning("{}: of other settings; the run is made again", file.string());
    return std::nullopt;
  }
  return *std::move(figures);
}

Result<void> keep(const PaperRequest& request, const PaperRun& run, const RunFigures& figures) {
  const fs::path file = figures_file(request, run);
  std::error_code failure;
  fs::create_directories(file.parent_path(), failure);
  if (failure) {
    return Error{
        fmt::format("{}: cannot be made: {}", file.parent_path().string(), failure.message())};
  }
  return write_file_atomically(file, run_figures_json(figures) + "\n");
}

/// What the runs gave, and how many failed.
struct Made {
  std::vector<RunFigures> figures;
  std::vector<std::string> failures;
  int reused = 0;
};

Result<Made> make_runs(const PaperRequest& request, const PaperPlan& plan) {
  const Result<ScratchFolder> scratch = ScratchFolder::make();
  if (!scratch) return scratch.error();
  Made made;
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const PaperRun& run = plan.runs[i];
    if (auto earlier = earlier_figures(request, run)) {
      made.figures.push_back(*std::move(earlier));
      ++made.reused;
      continue;
    }
    if (request.gather) {
      made.failures.push_back(
          fmt::format("{}, {}, run {}: not there", run.sequence.name, run.variant, run.run));
      continue;
    }
    log::info("run {} of {}: {}, {}, number {}", i + 1, plan.runs.size(), run.sequence.name,
              run.variant, run.run);
    Result<RunFigures> figures = make_paper_run(request, run, scratch->path());
    if (interruption::signal() != 0) {
      return Error{fmt::format("{} before run {} of {} was done; the same command goes on there",
                               interruption::signal_name(), i + 1, plan.runs.size())};
    }
    if (!figures) {
      made.failures.push_back(fmt::format("{}, {}, run {}: {}", run.sequence.name, run.variant,
                                          run.run, figures.error().message));
      log::warning("{}", made.failures.back());
      continue;
    }
    if (auto r = keep(request, run, *figures); !r) return r.error();
    made.figures.push_back(*std::move(figures));
  }
  return made;
}

std::vector<std::pair<std::string, std::string>> facts_of(const PaperRequest& request) {
  const nlohmann::ordered_json machine = machine_description();
  double load[1] = {0};
  const bool told = ::getloadavg(load, 1) == 1;
  const auto cores = machine.at("cores").get<unsigned>();
  std::string of_machine =
      fmt::format("{}, {} cores, {}", machine.at("processor").get<std::string>(), cores,
                  machine.at("system").get<std::string>());
  if (told) {
    of_machine += fmt::format(", load {:.1f}{}", load[0],
                              load[0] > 1.5 * cores ? ": busy, times are worth little" : "");
  }
  const std::string detector =
      request.detector.empty() ? std::string("the program's own network, every frame as default")
                               : request.detector;
  return {{"Program", fmt::format("ydd-slam {}", kVersion)},
          {"Machine", of_machine},
          {"Runs", fmt::format("{} of each variant, {}", request.runs,
                               request.realtime ? "at the camera's pace" : "flat out")},
          {"Detector", detector},
          {"Options",
           request.set.empty() ? "as default" : fmt::format("{}", fmt::join(request.set, " "))},
          {"RPE",
           "of consecutive frames; rotation as || R - I ||, unit-less (the article's figures "
           "are of that size)"}};
}

Result<void> write_report(const PaperRequest& request, const PaperReport& report) {
  const fs::path folder = request.out;
  const std::string machine = json_text(machine_description());
  if (auto r = write_file_atomically(folder / "paper.json", paper_json(report, machine)); !r) {
    return r;
  }
  if (auto r = write_file_atomically(folder / "paper.tex", paper_latex(report)); !r) return r;
  return write_file_atomically(folder / "paper.html", paper_page(report));
}

/// Sequences whose cameras were lost so soon that nothing can be scored.
void remark_unscored(const Made& made, std::vector<std::string>& remarks) {
  for (const RunFigures& run : made.figures) {
    if (run.variant == kNetworkAlone || run.values.contains("ate_m.rmse")) continue;
    remarks.push_back(
        fmt::format("{}, {}, run {}: no error, for want of ground truth or of "
                    "tracked frames",
                    run.sequence, run.variant, run.run));
  }
}

/// Clips are not what the article measured on.
void remark_clips(const Made& made, std::vector<std::string>& remarks) {
  constexpr double kClipShare = 0.7;
  for (const std::string& name : article_sequences()) {
    const auto run = std::find_if(made.figures.begin(), made.figures.end(), [&](const auto& each) {
      return each.sequence == name && each.values.contains("span_s");
    });
    if (run == made.figures.end()) continue;
    const double span_s = run->values.at("span_s");
    const double whole_s = published_duration_s(name).value();
    if (span_s > kClipShare * whole_s) continue;
    remarks.push_back(
        fmt::format("{}: {:.1f} s of the {:.1f} s of the published sequence: a clip, "
                    "the article's figures are not of the same",
                    name, span_s, whole_s));
  }
}

/// `SEQUENCE VARIANT NUMBER there` on a line for each run, or `missing`: what is damaged or of
/// other settings is missing.
std::string plan_text(const PaperRequest& request, const PaperPlan& plan) {
  std::string out;
  for (const PaperRun& run : plan.runs) {
    out += fmt::format("{} {} {} {}\n", run.sequence.name, run.variant, run.run,
                       earlier_figures(request, run) ? "there" : "missing");
  }
  return out;
}

/// The one run that is asked for. Nothing else in the folder is touched: others may work there.
Result<std::string> make_one(const PaperRequest& request, const PaperPlan& plan) {
  const auto run = std::find_if(plan.runs.begin(), plan.runs.end(), [&](const PaperRun& each) {
    return request.one ==
           std::vector<std::string>{each.sequence.name, each.variant, std::to_string(each.run)};
  });
  if (run == plan.runs.end()) {
    return Error{fmt::format("--one {}: no run of these options; --plan names them all",
                             fmt::join(request.one, " "))};
  }
  PaperPlan alone{plan.sequences, {*run}, {}};
  const Result<Made> made = make_runs(request, alone);
  if (!made) return made.error();
  if (!made->failures.empty()) return Error{made->failures.front()};
  return std::string();
}

PaperReport report_of(const PaperRequest& request, PaperPlan plan, Made made) {
  PaperReport report;
  report.remarks = std::move(plan.remarks);
  std::vector<RunFigures> systems;
  if (!request.systems.empty()) {
    systems = score_systems(request.systems, plan.sequences, report.remarks);
  }
  for (const PaperSequence& sequence : plan.sequences) {
    if (sequence.own) report.own.push_back(sequence.name);
  }
  for (const std::string& failed : made.failures) report.remarks.push_back("failed: " + failed);
  remark_clips(made, report.remarks);
  remark_unscored(made, report.remarks);
  const Article source = article();
  report.source = source.source;
  report.tables = fill_tables(source, made.figures, systems, report.own);
  report.facts = facts_of(request);
  report.runs = std::move(made.figures);
  return report;
}

/// All runs, or those that are there, and the pages.
Result<std::string> make_report(const PaperRequest& request, PaperPlan plan) {
  const Result<FileLock> lock = FileLock::take(fs::path(request.out) / ".lock", true);
  if (!lock) return Error{fmt::format("{}: another 'bench paper' works there", request.out)};
  Result<Made> made = make_runs(request, plan);
  if (!made) return made.error();
  const std::size_t runs = plan.runs.size();
  const int reused = made->reused;
  const std::vector<std::string> failures = made->failures;
  const PaperReport report = report_of(request, std::move(plan), *std::move(made));
  if (auto r = write_report(request, report); !r) return r.error();
  if (!failures.empty()) {
    return Error{fmt::format("{} of {} runs {}, the first: {}; {}", failures.size(), runs,
                             request.gather ? "are not there" : "failed", failures.front(),
                             request.gather ? "the pages are written without them"
                                            : "the same command tries them again")};
  }
  std::string said;
  for (const std::string& remark : report.remarks) said += remark + "\n";
  return said + fmt::format("{} runs ({} from before) in {}: paper.html, paper.json, paper.tex\n",
                            runs, reused, request.out);
}

}  // namespace

Result<std::string> bench_paper(const PaperRequest& request) {
  Result<PaperPlan> plan = find_sequences(request);
  if (!plan) return plan.error();
  plan_runs(request, *plan);
  if (request.plan) return plan_text(request, *plan);
  std::error_code failure;
  fs::create_directories(request.out, failure);
  if (failure) return Error{fmt::format("{}: cannot be made: {}", request.out, failure.message())};
  if (!request.one.empty()) return make_one(request, *plan);
  return make_report(request, *std::move(plan));
}

}  // namespace ydd::app
