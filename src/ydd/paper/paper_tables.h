// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ydd/paper/article.h"
#include "ydd/paper/run_figures.h"

namespace ydd {

/// How a figure of ours lies to the article's.
enum class Distance { unknown, near, better, worse };

/// Farther from the article's figure than this factor, either way, is far; an improvement is far
/// when it differs by `kFarPoints` percentage points.
inline constexpr double kFarFactor = 1.5;
inline constexpr double kFarPoints = 10.0;

/// The figures of some runs: their mean, as the article has it, and their spread.
struct PaperFigure {
  double mean = 0, low = 0, high = 0;
  int runs = 0;
};

/// A figure of ours beside the article's.
struct PaperCell {
  std::optional<PaperFigure> ours;
  std::optional<double> article;
  bool per_cent = false;  ///< an improvement
  Distance distance = Distance::unknown;
};

/// A row of a table of ours.
struct PaperRow {
  std::string name;
  std::vector<PaperCell> cells;
};

/// A table of the article with its figures beside ours; columns and rows beyond it have no figure
/// of the article.
struct PaperTable {
  int number = 0;
  std::string caption, unit, note;
  int decimals = 4;
  std::vector<std::string> columns;
  std::vector<PaperRow> rows;
};

/// The mean over runs of a value; nothing where no run has it.
std::optional<PaperFigure> figure_of(std::span<const RunFigures> runs, const std::string& sequence,
                                     const std::string& variant, const std::string& key);

/// Fills the article's tables. Variants and sequences of `runs` that the article does not have, and
/// other systems, are added. `systems`: runs of others, `variant` names the system. `own`: names of
/// recordings of the user's, for the tables that are about these.
std::vector<PaperTable> fill_tables(const Article& article, std::span<const RunFigures> runs,
                                    std::span<const RunFigures> systems,
                                    std::span<const std::string> own);

}  // namespace ydd
