// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "ydd/paper/paper_report.h"
#include "ydd/paper/paper_sequences.h"
#include "ydd/paper/paper_style.h"
#include "ydd/paper/svg_plot.h"

namespace ydd {
namespace {

/// The run that stands for a variant on a sequence: the one with the median error.
const RunFigures* typical_run(const PaperReport& report, const std::string& sequence,
                              const std::string& variant) {
  std::vector<const RunFigures*> runs;
  for (const RunFigures& run : report.runs) {
    if (run.sequence == sequence && run.variant == variant) runs.push_back(&run);
  }
  if (runs.empty()) return nullptr;
  const auto error = [](const RunFigures* run) {
    const auto value = run->values.find("ate_m.rmse");
    return value == run->values.end() ? std::numeric_limits<double>::max() : value->second;
  };
  std::stable_sort(runs.begin(), runs.end(),
                   [&](const RunFigures* a, const RunFigures* b) { return error(a) < error(b); });
  return runs[(runs.size() - 1) / 2];
}

struct Axes {
  int across = 0, up = 1;
};

/// The two axes along which there is most to see.
Axes axes_of(const RunCurves& curves) {
  const auto& points = curves.truth_m.empty() ? curves.estimate_m : curves.truth_m;
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  if (!points.empty()) low = high = points.front();
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Eigen::Index least = 0;
  (high - low).minCoeff(&least);
  return least == 0 ? Axes{1, 2} : least == 1 ? Axes{0, 2} : Axes{0, 1};
}

PlotLine line_of(const char* name, const char* colour, std::span<const Eigen::Vector3d> points,
                 Axes axes) {
  PlotLine line{name, colour, {}};
  for (const Eigen::Vector3d& p : points) line.points.emplace_back(p[axes.across], p[axes.up]);
  return line;
}

/// Truth, estimate and what lies between them, as the benchmark's tool draws it.
std::string path_plot(const RunFigures& run, const std::string& title) {
  const Axes axes = axes_of(run.curves);
  const char* const names[] = {"x in m", "y in m", "z in m"};
  Plot plot{title, names[axes.across], names[axes.up], {}, true};
  PlotLine between{"difference", "var(--error)", {}, true};
  // Every error would be a surface, not lines.
  const std::size_t step = run.curves.truth_m.size() / 150 + 1;
  for (std::size_t i = 0; i < run.curves.truth_m.size(); i += step) {
    for (const auto* points : {&run.curves.truth_m, &run.curves.estimate_m}) {
      between.points.emplace_back((*points)[i][axes.across], (*points)[i][axes.up]);
    }
  }
  if (!between.points.empty()) plot.lines.push_back(between);
  if (!run.curves.truth_m.empty()) {
    plot.lines.push_back(line_of("ground truth", "var(--truth)", run.curves.truth_m, axes));
  }
  plot.lines.push_back(line_of("estimate", "var(--estimate)", run.curves.estimate_m, axes));
  return svg_plot(plot);
}

std::string rpe_plot(const RunFigures& run, const std::string& title) {
  Plot plot{title, "time in s", "RPE in m", {}, false, true};
  PlotLine line{"", "var(--estimate)", {}};
  for (std::size_t i = 0; i < run.curves.rpe_m.size(); ++i) {
    line.points.emplace_back(run.curves.rpe_stamp_s[i], run.curves.rpe_m[i]);
  }
  plot.lines.push_back(std::move(line));
  return svg_plot(plot);
}

std::string requested_plot(const RunFigures& run, const std::string& title) {
  Plot plot{title, "frame", "feature points asked for", {}, false, true};
  PlotLine line{"per frame", "var(--estimate)", {}};
  double sum = 0;
  for (const double requested : run.curves.requested) {
    line.points.emplace_back(static_cast<double>(line.points.size()), requested);
    sum += requested;
  }
  const auto count = static_cast<double>(line.points.size());
  plot.lines.push_back(std::move(line));
  if (count > 0) {
    const double mean = sum / count;
    plot.lines.push_back({fmt::format("mean {:.0f}", mean),
                          "var(--error)",
                          {{0.0, mean}, {count - 1, mean}},
                          false,
                          true});
  }
  return svg_plot(plot);
}

const char* name_of_variant(const std::string& variant) {
  if (variant == "off") return "ORB-SLAM3's place: off";
  if (variant == "box") return "YOLO-SLAM3's place: box";
  if (variant == "person") return "Person-SLAM3's place: person";
  if (variant == "full") return "YDD-SLAM's place: full";
  return "evidence";
}

using Draw = std::string (*)(const RunFigures&, const std::string&);

/// Plots of variants on sequences; what was not run is left out.
std::string plots_of(const PaperReport& report, std::span<const std::string> sequences,
                     std::initializer_list<const char*> variants,
                     std::initializer_list<std::pair<const char*, Draw>> kinds) {
  std::string out;
  for (const std::string& sequence : sequences) {
    for (const auto& [kind, draw] : kinds) {
      for (const char* variant : variants) {
        const RunFigures* run = typical_run(report, sequence, variant);
        if (!run) continue;
        out += draw(*run, fmt::format("{}{}, {}", kind, sequence, name_of_variant(variant)));
      }
    }
  }
  return out;
}

std::string figure_section(int number, const std::string& what, const std::string& plots) {
  return fmt::format(
      "<section><h2>Figure {}: {}</h2>\n{}</section>\n", number, markup_text(what),
      plots.empty() ? std::string("<p class=\"dim\">Not drawn: none of its runs is there.</p>\n")
                    : "<div class=\"plots\">\n" + plots + "</div>\n");
}

std::string figure_sections(const PaperReport& report) {
  const std::vector<std::string>& five = article_sequences();
  std::vector<std::string> drives = report.own;
  for (const RunFigures& run : report.runs) {
    const bool known = std::find(drives.begin(), drives.end(), run.sequence) != drives.end();
    if (run.sequence.starts_with("bonn") && !known) drives.push_back(run.sequence);
  }
  const std::span<const std::string> walking(five.data(), 3);
  return figure_section(13, "absolute trajectory error and relative pose error, off and full",
                        plots_of(report, five, {"off", "full"},
                                 {{"ATE, ", &path_plot}, {"RPE, ", &rpe_plot}})) +
         figure_section(15, "absolute trajectory errors of the variants",
                        plots_of(report, walking, {"off", "box", "person", "full", "evidence"},
                                 {{"", &path_plot}})) +
         figure_section(16, "feature points asked for in each frame",
                        plots_of(report, five, {"full"}, {{"", &requested_plot}})) +
         figure_section(19, "trajectories of recordings of one's own, and of Bonn's",
                        plots_of(report, drives, {"off", "full", "evidence"}, {{"", &path_plot}}));
}

std::string cell_html(const PaperCell& cell, int decimals) {
  const char* kind = cell.distance == Distance::worse    ? " class=\"worse\""
                     : cell.distance == Distance::better ? " class=\"better\""
                                                         : "";
  const char* mark = cell.distance == Distance::worse    ? " ⊖"
                     : cell.distance == Distance::better ? " ⊕"
                                                         : "";
  std::string title;
  if (cell.ours && cell.ours->runs > 1) {
    title = fmt::format(" title=\"{} to {}, {} figures\"",
                        shown(cell.ours->low, decimals, cell.per_cent),
                        shown(cell.ours->high, decimals, cell.per_cent), cell.ours->runs);
  }
  const auto ours = cell.ours ? std::optional(cell.ours->mean) : std::nullopt;
  return fmt::format("<td{}{}><b>{}{}</b><i>{}</i></td>", kind, title,
                     shown(ours, decimals, cell.per_cent), mark,
                     shown(cell.article, decimals, cell.per_cent));
}

std::string table_html(const PaperTable& table) {
  std::string out = fmt::format(
      "<section><h2>Table {}: {} ({})</h2>\n<div class=\"scroll\"><table><thead><tr><th></th>",
      table.number, markup_text(table.caption), markup_text(table.unit));
  for (const std::string& column : table.columns) out += "<th>" + markup_text(column) + "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (const PaperRow& row : table.rows) {
    out += "<tr><th>" + markup_text(row.name) + "</th>";
    for (const PaperCell& cell : row.cells) out += cell_html(cell, table.decimals);
    out += "</tr>\n";
  }
  out += "</tbody></table></div>\n";
  if (!table.note.empty()) out += "<p class=\"dim\">" + markup_text(table.note) + "</p>\n";
  return out + "</section>\n";
}

}  // namespace

std::string paper_page(const PaperReport& report) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<title>The article's tables, measured again</title>\n<style>\n" +
      paper_page_style() +
      "</style>\n</head>\n<body>\n<h1>The article's tables, measured again</h1>\n";
  out += fmt::format(
      "<p>In each cell ours above, the mean of the runs, and below the figure of {} "
      "Far from the article's: ⊖ worse, ⊕ better, by more than a factor of {:.1f}, an improvement "
      "by more than {:.0f} points. In the place of ORB-SLAM3, YOLO-SLAM3, Person-SLAM3 and "
      "YDD-SLAM stand the variants off, box, person and full of this program; "
      "<code>evidence</code> is its default, which the article does not have.</p>\n<dl>\n",
      markup_text(report.source), kFarFactor, kFarPoints);
  for (const auto& [name, value] : report.facts) {
    out += "<dt>" + markup_text(name) + "</dt><dd>" + markup_text(value) + "</dd>\n";
  }
  out += "</dl>\n";
  if (!report.remarks.empty()) out += "<h2>To know</h2>\n<ul>\n";
  for (const std::string& remark : report.remarks) {
    out += "<li>" + markup_text(remark) + "</li>\n";
  }
  if (!report.remarks.empty()) out += "</ul>\n";
  for (const PaperTable& table : report.tables) out += table_html(table);
  return out + figure_sections(report) + "</body>\n</html>\n";
}

}  // namespace ydd
