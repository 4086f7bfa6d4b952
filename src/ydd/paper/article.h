// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// Which figure a column or row is about; a cell's is its row's and its column's together. Empty
/// texts: not told.
struct FigureSource {
  std::string sequence;   ///< empty in a whole cell: the mean over the article's sequences
  std::string variant;    ///< `off`, `box`, ..., or `network`: the detector alone
  std::string improves;   ///< per cent that `variant` is better than this one
  std::string system;     ///< somebody else's, by trajectory files
  std::string quantity;   ///< "ate_m", "rpe_m", "rpe_rotation", "tracking_ms", ...
  std::string statistic;  ///< "rmse", "mean", "median", "sd"; empty: the quantity is one number

  /// The name of the value in RunFigures::values: "ate_m.rmse".
  std::string key() const { return statistic.empty() ? quantity : quantity + "." + statistic; }
};

/// A column of a table of the article.
struct ArticleColumn {
  std::string name;
  FigureSource source;
};

/// A row of a table of the article.
struct ArticleRow {
  std::string name;
  FigureSource source;
  std::vector<std::optional<double>> figures;  ///< as printed, one per column; nothing: none
};

/// A table of the article.
struct ArticleTable {
  int number = 0;
  std::string caption, unit, note;
  int decimals = 4;
  bool extend = false;   ///< rows are sequences, and more may follow
  bool turned = false;   ///< the article has its rows as columns
  bool own = false;      ///< rows are recordings of one's own
  bool systems = false;  ///< more systems may follow as columns
  std::vector<ArticleColumn> columns;
  std::vector<ArticleRow> rows;
};

/// An article and its tables.
struct Article {
  std::string source;  ///< where it was published
  std::vector<ArticleTable> tables;
};

/// Reads article.json of this folder. Failure: one line that begins with `origin`.
Result<Article> parse_article(std::string_view json, std::string_view origin);

/// The tables 3 to 13 that come with the program.
Article article();

}  // namespace ydd
