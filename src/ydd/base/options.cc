// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/yaml_reader.h"

namespace ydd {
namespace {

template <class Number>
bool parse_number(std::string_view text, Number& out) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), out);
  return ec == std::errc() && end == text.data() + text.size();
}

std::string format_range(const Range& range) {
  const bool low = std::isfinite(range.min);
  const bool high = std::isfinite(range.max);
  if (low && high) return fmt::format(" in [{}, {}]", range.min, range.max);
  if (low) return fmt::format(" >= {}", range.min);
  if (high) return fmt::format(" <= {}", range.max);
  return "";
}

/// What may stand there, for an error message: "a whole number in [1, 16] px".
std::string expected(const Option& option) {
  const std::string unit = option.unit.empty() ? "" : " " + option.unit;
  if (std::holds_alternative<bool*>(option.target)) return "true or false";
  if (std::holds_alternative<int*>(option.target)) {
    return "a whole number" + format_range(option.range) + unit;
  }
  if (std::holds_alternative<double*>(option.target)) {
    return "a number" + format_range(option.range) + unit;
  }
  if (option.choices.empty()) return "text";
  return fmt::format("one of {}", fmt::join(option.choices, ", "));
}

bool in_range(const Option& option, double value) {
  return std::isfinite(value) && value >= option.range.min && value <= option.range.max;
}

bool assign(const Option& option, std::string_view text) {
  if (auto* const* b = std::get_if<bool*>(&option.target)) {
    if (text != "true" && text != "false") return false;
    **b = text == "true";
    return true;
  }
  if (auto* const* i = std::get_if<int*>(&option.target)) {
    int value = 0;
    if (!parse_number(text, value) || !in_range(option, value)) return false;
    **i = value;
    return true;
  }
  if (auto* const* d = std::get_if<double*>(&option.target)) {
    double value = 0;
    if (!parse_number(text, value) || !in_range(option, value)) return false;
    **d = value;
    return true;
  }
  const auto& choices = option.choices;
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (!choices.empty() && found == choices.end()) return false;
  if (const auto* choice = std::get_if<ChoiceTarget>(&option.target)) {
    choice->set(choice->place, static_cast<std::size_t>(found - choices.begin()));
    return true;
  }
  *std::get<std::string*>(option.target) = std::string(text);
  return true;
}

/// Sets what `node` holds. A key can stand twice, as "a.b: 1" and below "a:".
class YamlLoader {
 public:
  YamlLoader(OptionTable& table, std::string file) : table_(table), file_(std::move(file)) {}

  Result<void> load(const YAML::Node& node, const std::string& prefix) {
    for (const auto& entry : node) {
      const std::string source = yaml_line(file_, entry.first);
      if (!entry.first.IsScalar()) return Error{source + ": a key must be plain text"};
      const std::string key = prefix + entry.first.Scalar();
      if (entry.second.IsMap()) {
        if (auto r = load(entry.second, key + "."); !r) return r;
      } else if (!entry.second.IsScalar()) {
        return Error{fmt::format("{}: '{}' must be a single value", source, on_one_line(key))};
      } else if (auto r = set(key, entry.second.Scalar(), source); !r) {
        return r;
      }
    }
    return {};
  }

 private:
  Result<void> set(const std::string& key, const std::string& text, const std::string& source) {
    const auto [first, is_new] = set_.try_emplace(key, text, source);
    const auto& [first_text, first_source] = first->second;
    if (!is_new && first_text != text) {
      return Error{fmt::format("{}: '{}' is '{}' here and '{}' at {}; keep one", source, key, text,
                               first_text, first_source)};
    }
    return table_.set(key, text, source);
  }

  OptionTable& table_;
  std::string file_;
  std::map<std::string, std::pair<std::string, std::string>> set_;  ///< key: text, source
};

/// How many letters must change, come or go to make `b` of `a`.
std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (const char letter : a) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (letter == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// "; did you mean 'orb.levels'?" when one option is near: three slips, another group, no unit.
std::string suggestion(const std::vector<Option>& options, std::string_view key) {
  constexpr std::size_t kLongest = 80;
  constexpr std::size_t kMostEdits = 3;
  if (key.size() > kLongest) return "";
  std::string best;
  std::size_t fewest = kMostEdits + 1;
  for (const Option& option : options) {
    const std::string_view known = option.key;
    const std::string tail = "." + std::string(key);
    const bool lacks_unit = known.starts_with(std::string(key) + "_");
    const std::size_t edits = known.ends_with(tail) || lacks_unit ? 1 : edits_between(key, known);
    if (edits >= fewest || edits >= key.size()) continue;
    fewest = edits;
    best = known;
  }
  return best.empty() ? "" : fmt::format("; did you mean '{}'?", best);
}

}  // namespace

Option& OptionTable::append(std::string_view key, std::string_view sentence) {
  Option option;
  option.key = prefix_ + std::string(key);
  option.sentence = std::string(sentence);
  return options_.emplace_back(std::move(option));
}

void OptionTable::add(std::string_view key, bool& value, std::string_view sentence) {
  append(key, sentence).target = &value;
}

void OptionTable::add(std::string_view key, int& value, Range range, std::string_view unit,
                      std::string_view sentence) {
  Option& option = append(key, sentence);
  option.target = &value;
  option.range = range;
  option.unit = unit;
}

void OptionTable::add(std::string_view key, double& value, Range range, std::string_view unit,
                      std::string_view sentence) {
  Option& option = append(key, sentence);
  option.target = &value;
  option.range = range;
  option.unit = unit;
}

void OptionTable::add(std::string_view key, std::string& value, std::vector<std::string> choices,
                      std::string_view sentence) {
  Option& option = append(key, sentence);
  option.target = &value;
  option.choices = std::move(choices);
}

void OptionTable::add_choice(std::string_view key, std::vector<std::string> choices,
                             ChoiceTarget target, std::string_view sentence) {
  Option& option = append(key, sentence);
  option.target = target;
  option.choices = std::move(choices);
}

Result<void> OptionTable::set(std::string_view key, std::string_view text,
                              std::string_view source) {
  const auto found = std::find_if(options_.begin(), options_.end(),
                                  [&](const Option& option) { return option.key == key; });
  if (found == options_.end()) {
    return Error{fmt::format("{}: unknown option '{}'{}; 'ydd-slam options' lists them all", source,
                             on_one_line(std::string(key)), suggestion(options_, key))};
  }
  if (!assign(*found, text)) {
    return Error{fmt::format("{}: '{}' is '{}' but must be {}", source, key,
                             on_one_line(std::string(text)), expected(*found))};
  }
  return {};
}

Result<void> OptionTable::set_assignment(std::string_view assignment, std::string_view source) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    return Error{fmt::format("{}: '{}' is not of the form key=value", source, assignment)};
  }
  return set(assignment.substr(0, equals), assignment.substr(equals + 1), source);
}

Result<void> OptionTable::load_yaml(const std::filesystem::path& file) {
  const Result<YAML::Node> root = read_yaml(file);
  if (!root) return root.error();
  if (root->IsNull()) return {};
  if (!root->IsMap()) {
    return Error{fmt::format("{}: must hold 'key: value' lines", file.string())};
  }
  return YamlLoader(*this, file.string()).load(*root, "");
}

std::string format_value(const Option& option) {
  if (auto* const* b = std::get_if<bool*>(&option.target)) return **b ? "true" : "false";
  if (auto* const* i = std::get_if<int*>(&option.target)) return fmt::format("{}", **i);
  if (auto* const* d = std::get_if<double*>(&option.target)) return fmt::format("{}", **d);
  YAML::Emitter out;
  if (const auto* choice = std::get_if<ChoiceTarget>(&option.target)) {
    out << option.choices.at(choice->get(choice->place));
    return out.c_str();
  }
  out << *std::get<std::string*>(option.target);
  return out.c_str();
}

std::string OptionTable::to_yaml() const {
  std::string text;
  std::vector<std::string> open;  // groups that the last line was in
  for (const Option& option : options_) {
    std::vector<std::string> path;
    std::size_t start = 0;
    for (std::size_t dot = option.key.find('.'); dot != std::string::npos;
         dot = option.key.find('.', start)) {
      path.push_back(option.key.substr(start, dot - start));
      start = dot + 1;
    }
    const auto common = std::mismatch(path.begin(), path.end(), open.begin(), open.end()).first;
    for (auto it = common; it != path.end(); ++it) {
      text += fmt::format("{:{}}{}:\n", "", 2 * (it - path.begin()), *it);
    }
    open = path;
    text += fmt::format(
        "{:{}}{}: {}  # {}{}{}\n", "", 2 * path.size(), option.key.substr(start),
        format_value(option), option.unit.empty() ? "" : "[" + option.unit + "] ", option.sentence,
        option.choices.empty() ? format_range(option.range)
                               : fmt::format(" ({})", fmt::join(option.choices, " | ")));
  }
  return text;
}

}  // namespace ydd
