// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "ydd/paper/paper_report.h"

namespace ydd {
namespace {

/// Text for LaTeX, whatever it holds.
std::string latex_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\':
        out += "\\textbackslash{}";
        break;
      case '~':
        out += "\\textasciitilde{}";
        break;
      case '^':
        out += "\\textasciicircum{}";
        break;
      case '_':
      case '%':
      case '&':
      case '#':
      case '$':
      case '{':
      case '}':
        out += {'\\', c};
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string latex_cell(const PaperCell& cell, int decimals) {
  if (!cell.ours && !cell.article) return "--";
  std::string out =
      shown(cell.ours ? std::optional(cell.ours->mean) : std::nullopt, decimals, cell.per_cent);
  if (cell.distance == Distance::worse) out += "$^{\\ominus}$";
  if (cell.distance == Distance::better) out += "$^{\\oplus}$";
  if (cell.article) out += " (" + shown(cell.article, decimals, cell.per_cent) + ")";
  return out;
}

std::string latex_table(const PaperTable& table) {
  std::string out = fmt::format(
      "\\begin{{table}}[p]\n\\caption{{Table {} of the article: {} [{}]. {}}}\n"
      "\\resizebox{{\\textwidth}}{{!}}{{%\n\\begin{{tabular}}{{l{}}}\n\\toprule\n",
      table.number, latex_text(table.caption), latex_text(table.unit), latex_text(table.note),
      std::string(table.columns.size(), 'r'));
  for (const std::string& column : table.columns) out += " & " + latex_text(column);
  out += " \\\\\n\\midrule\n";
  for (const PaperRow& row : table.rows) {
    out += latex_text(row.name);
    for (const PaperCell& cell : row.cells) out += " & " + latex_cell(cell, table.decimals);
    out += " \\\\\n";
  }
  return out + "\\bottomrule\n\\end{tabular}}\n\\end{table}\n\n";
}

}  // namespace

std::string shown(std::optional<double> value, int decimals, bool per_cent) {
  return value ? fmt::format("{:.{}f}", *value, per_cent ? 2 : decimals) : std::string("–");
}

std::string paper_latex(const PaperReport& report) {
  std::string out =
      "% Made by ydd-slam bench paper.\n"
      "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n"
      "\\usepackage[a4paper,landscape,margin=15mm]{geometry}\n"
      "\\usepackage{booktabs}\n\\usepackage{graphicx}\n\\begin{document}\n"
      "\\noindent Ours, and in brackets the figures of: " +
      latex_text(report.source) +
      fmt::format(
          "\n$\\ominus$ worse, $\\oplus$ better than the article's by more than a factor of "
          "{:.1f}, an improvement by more than {:.0f} "
          "points.\n\\begin{{itemize}}\n",
          kFarFactor, kFarPoints);
  for (const auto& [name, value] : report.facts) {
    out += "\\item " + latex_text(name) + ": " + latex_text(value) + "\n";
  }
  for (const std::string& remark : report.remarks) out += "\\item " + latex_text(remark) + "\n";
  out += "\\end{itemize}\n";
  for (const PaperTable& table : report.tables) out += latex_table(table);
  return out + "\\end{document}\n";
}

}  // namespace ydd
