// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ydd/paper/paper_tables.h"

namespace ydd {

/// All that there is to tell about an article's tables measured again.
struct PaperReport {
  std::string source;  ///< the article
  std::vector<PaperTable> tables;
  std::vector<RunFigures> runs;      ///< ours
  std::vector<std::string> own;      ///< names of recordings of the user's
  std::vector<std::string> remarks;  ///< what is missing, what failed, what to know of the figures
  std::vector<std::pair<std::string, std::string>> facts;  ///< machine, version, settings
};

/// One page with the tables and with the article's figures 13, 15, 16 and 19 drawn from `runs`. It
/// needs no other file, no network and no script.
std::string paper_page(const PaperReport& report);

/// A LaTeX document with the tables: ours, and the article's in brackets.
std::string paper_latex(const PaperReport& report);

/// Everything but the curves as JSON; `groups` are as tools/compare-results reads them.
/// `machine_json`: an object that tells what times depend on.
std::string paper_json(const PaperReport& report, const std::string& machine_json);

/// A number of a table: ours as "0.0151", nothing as a dash.
std::string shown(std::optional<double> value, int decimals, bool per_cent);

}  // namespace ydd
