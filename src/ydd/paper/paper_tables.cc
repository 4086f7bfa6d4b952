// SPDX-License-Identifier: Apache-2.0
#include "ydd/paper/paper_tables.h"

#include <algorithm>
#include <set>

#include "ydd/paper/paper_sequences.h"

namespace ydd {
namespace {

/// What tables are filled from.
struct Measured {
  std::span<const RunFigures> runs, systems;
  std::span<const std::string> own;
};

bool contains(std::span<const std::string> names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

PaperFigure summary_of(std::span<const double> values) {
  PaperFigure out{0, values[0], values[0], static_cast<int>(values.size())};
  for (const double value : values) {
    out.mean += value / static_cast<double>(values.size());
    out.low = std::min(out.low, value);
    out.high = std::max(out.high, value);
  }
  return out;
}

/// A value on one sequence, or its mean over those of the article that were run.
std::optional<PaperFigure> value_of(const FigureSource& source, const std::string& variant,
                                    std::span<const RunFigures> runs) {
  if (!source.sequence.empty()) return figure_of(runs, source.sequence, variant, source.key());
  std::vector<double> means;
  for (const std::string& sequence : article_sequences()) {
    if (const auto one = figure_of(runs, sequence, variant, source.key())) {
      means.push_back(one->mean);
    }
  }
  if (means.empty()) return std::nullopt;
  return summary_of(means);
}

std::optional<PaperFigure> improvement_of(const FigureSource& source, const Measured& measured) {
  const auto before = value_of(source, source.improves, measured.runs);
  const auto after = value_of(source, source.variant, measured.runs);
  if (!before || !after || before->mean <= 0) return std::nullopt;
  const double per_cent = 100 * (before->mean - after->mean) / before->mean;
  return PaperFigure{per_cent, per_cent, per_cent, std::min(before->runs, after->runs)};
}

Distance distance_of(double ours, double article, bool per_cent) {
  if (per_cent) {
    const double points = ours - article;
    if (points > kFarPoints) return Distance::better;
    return points < -kFarPoints ? Distance::worse : Distance::near;
  }
  if (ours > kFarFactor * article) return Distance::worse;
  return ours * kFarFactor < article ? Distance::better : Distance::near;
}

FigureSource joined(const FigureSource& row, const FigureSource& column) {
  const auto either = [](const std::string& a, const std::string& b) { return a.empty() ? b : a; };
  return {either(column.sequence, row.sequence), either(column.variant, row.variant),
          either(column.improves, row.improves), either(column.system, row.system),
          either(column.quantity, row.quantity), either(column.statistic, row.statistic)};
}

PaperCell cell_of(const FigureSource& source, std::optional<double> article,
                  const Measured& measured) {
  PaperCell cell;
  cell.article = article;
  cell.per_cent = !source.improves.empty();
  if (source.quantity.empty()) return cell;
  if (!source.system.empty()) {
    cell.ours = value_of(source, source.system, measured.systems);
  } else if (cell.per_cent) {
    cell.ours = improvement_of(source, measured);
  } else if (!source.variant.empty()) {
    cell.ours = value_of(source, source.variant, measured.runs);
  }
  if (cell.ours && article) {
    cell.distance = distance_of(cell.ours->mean, *article, cell.per_cent);
  }
  return cell;
}

/// Names in the order in which they come.
template <class Name>
std::vector<std::string> names_of(std::span<const RunFigures> runs, Name name) {
  std::vector<std::string> out;
  for (const RunFigures& run : runs) {
    if (!contains(out, name(run))) out.push_back(name(run));
  }
  return out;
}

/// The variant that the article does not have.
constexpr const char* kBeyond = "evidence";

bool has_beyond(const Measured& measured) {
  return std::any_of(measured.runs.begin(), measured.runs.end(),
                     [](const RunFigures& run) { return run.variant == kBeyond; });
}

/// `evidence` beside `full`, whatever the table has them as.
void add_beyond(ArticleTable& table) {
  const auto add = [](auto& list) {
    for (std::size_t i = 0, end = list.size(); i < end; ++i) {
      if (list[i].source.variant != "full" || !list[i].source.improves.empty()) continue;
      auto copy = list[i];
      copy.source.variant = kBeyond;
      const std::string theirs = "YDD-SLAM";
      const std::size_t at = copy.name.find(theirs);
      copy.name = at == std::string::npos ? std::string(kBeyond) + " " + copy.name
                                          : copy.name.replace(at, theirs.size(), kBeyond);
      list.push_back(std::move(copy));
    }
  };
  const std::size_t columns = table.columns.size();
  const std::size_t rows = table.rows.size();
  add(table.columns);
  add(table.rows);
  for (std::size_t r = rows; r < table.rows.size(); ++r) {
    std::fill(table.rows[r].figures.begin(), table.rows[r].figures.end(), std::nullopt);
    // The machine that the article names is not this one.
    table.rows[r].name = kBeyond;
  }
  for (ArticleRow& row : table.rows) {
    row.figures.resize(row.figures.size() + table.columns.size() - columns);
  }
}

/// Systems whose trajectories are there and that the table does not name.
void add_systems(ArticleTable& table, const Measured& measured) {
  std::set<std::string> known;
  for (const ArticleColumn& column : table.columns) known.insert(column.source.system);
  for (const std::string& system :
       names_of(measured.systems, [](const RunFigures& run) { return run.variant; })) {
    if (known.contains(system)) continue;
    FigureSource source = table.columns.front().source;
    source.variant.clear();
    source.system = system;
    table.columns.push_back({system + " (here)", source});
    for (ArticleRow& row : table.rows) row.figures.emplace_back();
  }
}

/// Sequences that were run and that the table does not have.
void add_sequences(ArticleTable& table, const Measured& measured) {
  std::set<std::string> known;
  for (const ArticleRow& row : table.rows) known.insert(row.source.sequence);
  for (const std::string& name :
       names_of(measured.runs, [](const RunFigures& run) { return run.sequence; })) {
    if (known.contains(name) || contains(measured.own, name) != table.own) continue;
    FigureSource source;
    source.sequence = name;
    table.rows.push_back({name, source, std::vector<std::optional<double>>(table.columns.size())});
  }
}

/// The article's name, and what of this program stands in its place.
std::string name_beside_ours(const std::string& name, const FigureSource& source) {
  const bool ours = source.improves.empty() && !source.variant.empty();
  return ours && source.variant != kBeyond ? name + " / " + source.variant : name;
}

PaperTable filled(ArticleTable table, const Measured& measured) {
  if (has_beyond(measured)) add_beyond(table);
  if (table.systems) add_systems(table, measured);
  if (table.extend || table.own) add_sequences(table, measured);
  PaperTable out{table.number, table.caption, table.unit, table.note, table.decimals, {}, {}};
  if (table.turned) out.note += out.note.empty() ? "" : " ";
  if (table.turned) out.note += "The article has its rows as columns.";
  for (const ArticleColumn& column : table.columns) {
    out.columns.push_back(name_beside_ours(column.name, column.source));
  }
  for (const ArticleRow& row : table.rows) {
    PaperRow& made = out.rows.emplace_back(PaperRow{name_beside_ours(row.name, row.source), {}});
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const FigureSource source = joined(row.source, table.columns[c].source);
      made.cells.push_back(cell_of(source, row.figures[c], measured));
    }
  }
  return out;
}

}  // namespace

std::optional<PaperFigure> figure_of(std::span<const RunFigures> runs, const std::string& sequence,
                                     const std::string& variant, const std::string& key) {
  std::vector<double> values;
  for (const RunFigures& run : runs) {
    const auto value = run.values.find(key);
    if (run.sequence == sequence && run.variant == variant && value != run.values.end()) {
      values.push_back(value->second);
    }
  }
  if (values.empty()) return std::nullopt;
  return summary_of(values);
}

std::vector<PaperTable> fill_tables(const Article& article, std::span<const RunFigures> runs,
                                    std::span<const RunFigures> systems,
                                    std::span<const std::string> own) {
  std::vector<PaperTable> out;
  for (const ArticleTable& table : article.tables) {
    out.push_back(filled(table, {runs, systems, own}));
  }
  return out;
}

}  // namespace ydd
