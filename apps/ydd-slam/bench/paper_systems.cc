// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "bench/bench_paper.h"
#include "ydd/sources/source.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

/// Files of a folder and folders in it, by name.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code failure;
  fs::directory_iterator entries(folder, failure);
  for (; !failure && entries != fs::directory_iterator(); entries.increment(failure)) {
    out.push_back(entries->path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The sequence that a file is about: its name as a folder's, a Bonn sequence or one of the user's
/// by the beginning ("bonn_crowd_2.txt"; the longest that fits).
const PaperSequence* sequence_of(const fs::path& file,
                                 const std::vector<PaperSequence>& sequences) {
  const std::string stem = file.stem().string();
  const std::string name = sequence_name(stem).value_or(stem);
  const PaperSequence* best = nullptr;
  for (const PaperSequence& sequence : sequences) {
    if (!name.starts_with(sequence.name)) continue;
    if (!best || sequence.name.size() > best->name.size()) best = &sequence;
  }
  return best;
}

/// Ground truth of the sequences, each read once.
class Truths {
 public:
  const Result<StampedPoses>& of(const PaperSequence& sequence) {
    const auto known = truths_.find(sequence.name);
    if (known != truths_.end()) return known->second;
    return truths_.emplace(sequence.name, read(sequence)).first->second;
  }

 private:
  static Result<StampedPoses> read(const PaperSequence& sequence) {
    const Result<Recording> recording = open_recording(sequence.folder);
    if (!recording) return recording.error();
    if (!recording->groundtruth) {
      return Error{fmt::format("{}: has no ground truth", sequence.folder.string())};
    }
    return recording->groundtruth->read();
  }
  std::map<std::string, Result<StampedPoses>> truths_;
};

Result<RunFigures> score(const fs::path& file, const PaperSequence& sequence, Truths& truths) {
  const Result<StampedPoses>& truth = truths.of(sequence);
  if (!truth) return truth.error();
  const Result<StampedPoses> trajectory = read_tum_trajectory(file);
  if (!trajectory) return trajectory.error();
  RunFigures figures;
  figures.sequence = sequence.name;
  score_trajectory(*truth, *trajectory, figures);
  if (figures.values.empty()) {
    return Error{fmt::format("{}: fewer than three poses have a true one within 20 ms on {}",
                             file.string(), sequence.name)};
  }
  return figures;
}

}  // namespace

std::vector<RunFigures> score_systems(const fs::path& folder,
                                      const std::vector<PaperSequence>& sequences,
                                      std::vector<std::string>& remarks) {
  std::vector<RunFigures> out;
  Truths truths;
  for (const fs::path& system : entries_of(folder)) {
    std::map<std::string, int> runs;
    for (const fs::path& file : entries_of(system)) {
      const PaperSequence* const sequence = sequence_of(file, sequences);
      if (!sequence) {
        remarks.push_back(fmt::format("{}: of no sequence that is here, left out", file.string()));
        continue;
      }
      Result<RunFigures> figures = score(file, *sequence, truths);
      if (!figures) {
        remarks.push_back(figures.error().message + "; left out");
        continue;
      }
      figures->variant = system.filename().string();
      figures->run = ++runs[sequence->name];
      out.push_back(*std::move(figures));
    }
  }
  return out;
}

}  // namespace ydd::app
