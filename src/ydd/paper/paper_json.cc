// SPDX-License-Identifier: Apache-2.0
#include <map>

#include <nlohmann/json.hpp>

#include "ydd/base/json_reader.h"
#include "ydd/base/json_text.h"
#include "ydd/base/timing.h"
#include "ydd/paper/paper_report.h"

namespace ydd {
namespace {

using PaperJson = nlohmann::ordered_json;

const char* word_of(Distance distance) {
  switch (distance) {
    case Distance::near:
      return "near";
    case Distance::better:
      return "far, better";
    case Distance::worse:
      return "far, worse";
    case Distance::unknown:
      break;
  }
  return "unknown";
}

PaperJson cell_json(const PaperCell& cell) {
  PaperJson out = {{"ours", nullptr}, {"article", nullptr}, {"distance", word_of(cell.distance)}};
  if (cell.article) out["article"] = *cell.article;
  if (cell.ours) {
    out["ours"] = cell.ours->mean;
    out["low"] = cell.ours->low;
    out["high"] = cell.ours->high;
    out["runs"] = cell.ours->runs;
  }
  return out;
}

PaperJson table_json(const PaperTable& table) {
  PaperJson rows = PaperJson::array();
  for (const PaperRow& row : table.rows) {
    PaperJson cells = PaperJson::array();
    for (const PaperCell& cell : row.cells) cells.push_back(cell_json(cell));
    rows.push_back({{"name", row.name}, {"cells", cells}});
  }
  return {{"number", table.number}, {"caption", table.caption}, {"unit", table.unit},
          {"note", table.note},     {"columns", table.columns}, {"rows", rows}};
}

/// How tools/compare-results knows a quantity: its name there, unit, what is better.
struct Compared {
  const char *key, *name, *unit, *better;
};
constexpr Compared kCompared[] = {
    {"ate_m.rmse", "ate_rmse_m", "m", "lower"},
    {"rpe_m.rmse", "rpe_rmse_m", "m", "lower"},
    {"rpe_rotation.rmse", "rpe_rotation_rmse", "unit-less", "lower"},
    {"tracked_share", "tracked_share", "share", "higher"},
    {"tracking_ms.median", "tracking_median_ms", "ms", "lower"},
    {"decision_ms.mean", "decision_mean_ms", "ms", "lower"},
    {"network_ms.mean", "network_mean_ms", "ms", "lower"},
    {"resident_mb", "resident_mb", "MB", "lower"},
};

PaperJson groups_of(const PaperReport& report, const PaperJson& machine) {
  std::map<std::string, std::vector<double>> series;
  std::map<std::string, const Compared*> kinds;
  for (const RunFigures& run : report.runs) {
    for (const Compared& compared : kCompared) {
      const auto value = run.values.find(compared.key);
      const std::string name = run.sequence + "/" + run.variant + "/" + compared.name;
      // A run without a score is a figure as well: none.
      const bool expected = run.variant != "network" && std::string(compared.unit) == "m";
      if (value == run.values.end() && !expected) continue;
      kinds[name] = &compared;
      std::vector<double>& values = series[name];
      if (value != run.values.end()) values.push_back(value->second);
    }
  }
  PaperJson figures = PaperJson::object();
  for (const auto& [name, values] : series) {
    PaperJson figure = {{"unit", kinds[name]->unit}, {"better", kinds[name]->better}};
    const SeriesStatistics s = statistics_of(values);
    for (const auto& [key, value] :
         {std::pair("median", s.median), std::pair("min", s.min), std::pair("max", s.max)}) {
      figure[key] = values.empty() ? PaperJson() : PaperJson(value);
    }
    figure["runs"] = values;
    figures[name] = figure;
  }
  return {{"paper", {{"machine", machine}, {"figures", figures}}}};
}

}  // namespace

std::string paper_json(const PaperReport& report, const std::string& machine_json) {
  const PaperJson machine = parse_json(machine_json, "machine").value();
  PaperJson tables = PaperJson::array();
  for (const PaperTable& table : report.tables) tables.push_back(table_json(table));
  PaperJson facts = PaperJson::object();
  for (const auto& [name, value] : report.facts) facts[name] = value;
  return json_text(PaperJson{{"format", "ydd-slam paper 1"},
                             {"article", report.source},
                             {"facts", facts},
                             {"remarks", report.remarks},
                             {"tables", tables},
                             {"groups", groups_of(report, machine)}},
                   1) +
         "\n";
}

}  // namespace ydd
