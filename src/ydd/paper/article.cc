// SPDX-License-Identifier: Apache-2.0
#include "ydd/paper/article.h"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "article.inc"
#include "ydd/base/json_reader.h"
#include "ydd/base/one_line.h"

namespace ydd {
namespace {

using ArticleJson = nlohmann::ordered_json;

/// Of the members that a row or column has; json's own exceptions tell what is wrong with others.
FigureSource source_of(const ArticleJson& json) {
  const auto text = [&](const char* key) { return json.value(key, std::string()); };
  return {text("sequence"), text("variant"),  text("improves"),
          text("system"),   text("quantity"), text("statistic")};
}

ArticleRow row_of(const ArticleJson& json, std::size_t columns) {
  ArticleRow row{json.at("name").get<std::string>(), source_of(json), {}};
  for (const ArticleJson& figure : json.at("figures")) {
    row.figures.push_back(figure.is_null() ? std::nullopt
                                           : std::optional<double>(figure.get<double>()));
  }
  if (row.figures.size() != columns) {
    throw std::invalid_argument(fmt::format("row '{}' has {} figures, the table {} columns",
                                            row.name, row.figures.size(), columns));
  }
  return row;
}

ArticleTable table_of(const ArticleJson& json) {
  ArticleTable table;
  table.number = json.at("number").get<int>();
  table.caption = json.at("caption").get<std::string>();
  table.unit = json.at("unit").get<std::string>();
  table.note = json.value("note", std::string());
  table.decimals = json.value("decimals", 4);
  table.extend = json.value("extend", false);
  table.turned = json.value("turned", false);
  table.own = json.value("own", false);
  table.systems = json.value("systems", false);
  for (const ArticleJson& column : json.at("columns")) {
    table.columns.push_back({column.at("name").get<std::string>(), source_of(column)});
  }
  for (const ArticleJson& row : json.at("rows")) {
    table.rows.push_back(row_of(row, table.columns.size()));
  }
  return table;
}

}  // namespace

Result<Article> parse_article(std::string_view json, std::string_view origin) {
  const auto read = parse_json(json, origin);
  if (!read) return read.error();
  try {
    Article article{read->at("source").get<std::string>(), {}};
    for (const ArticleJson& table : read->at("tables")) article.tables.push_back(table_of(table));
    return article;
  } catch (const std::exception& e) {
    return Error{fmt::format("{}: {}", origin, on_one_line(e.what()))};
  }
}

Article article() {
  std::string text;
  for (const std::string_view piece : kArticle) text += piece;
  return parse_article(text, "article.json").value();
}

}  // namespace ydd
