// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ydd/base/choice.h"
#include "ydd/base/result.h"

namespace ydd {

/// Inclusive bounds of a numeric option.
struct Range {
  double min = -std::numeric_limits<double>::infinity();  ///< least value that is allowed
  double max = std::numeric_limits<double>::infinity();   ///< largest value that is allowed
};

/// An enumeration somewhere, by the number of its value.
struct ChoiceTarget {
  void* place = nullptr;                                  ///< the enumeration's value
  std::size_t (*get)(const void* place) = nullptr;        ///< its number, from 0
  void (*set)(void* place, std::size_t value) = nullptr;  ///< sets it by its number
};

/// One setting: where its value lives, what may stand there, and a sentence about it.
struct Option {
  std::string key;                   ///< dotted: "orb.levels"
  std::string unit;                  ///< "px", "m", "s"; empty for a plain number
  Range range;                       ///< of a number; else without bounds
  std::vector<std::string> choices;  ///< of an enumeration; for a text option also empty: any text
  std::string sentence;              ///< what it does, for people
  std::variant<bool*, int*, double*, std::string*, ChoiceTarget> target;  ///< where its value lives
};

/// All options of a structure, bound to its members.
///
/// A structure takes part by describing itself once:
///
///     struct OrbOptions {
///       int levels = 8;
///       void describe(OptionTable& t) { t.add("levels", levels, {1, 16}, "", "pyramid levels"); }
///     };
///
/// and defaults, YAML files, `--set`, range checks, the saved effective configuration and the
/// documentation all come from that. The structure must outlive the table.
class OptionTable {
 public:
  void add(std::string_view key, bool& value, std::string_view sentence);  ///< A switch.
  /// A whole number in a range; `unit` may be empty.
  void add(std::string_view key, int& value, Range range, std::string_view unit,
           std::string_view sentence);
  /// A number in a range; `unit` may be empty.
  void add(std::string_view key, double& value, Range range, std::string_view unit,
           std::string_view sentence);
  /// Text: one of `choices`, or any where these are empty.
  void add(std::string_view key, std::string& value, std::vector<std::string> choices,
           std::string_view sentence);
  /// A value of an enumeration, by its name.
  template <Choice E>
  void add(std::string_view key, E& value, std::string_view sentence) {
    const auto names = choices_of(value);
    add_choice(
        key, {names.begin(), names.end()},
        {&value,
         [](const void* place) { return static_cast<std::size_t>(*static_cast<const E*>(place)); },
         [](void* place, std::size_t number) { *static_cast<E*>(place) = static_cast<E>(number); }},
        sentence);
  }

  /// Adds the options of `part` below `key`.
  template <class Part>
  void group(std::string_view key, Part& part) {
    const std::string outer = prefix_;
    prefix_ += std::string(key) + ".";
    part.describe(*this);
    prefix_ = outer;
  }

  /// Sets one option from text. `source` starts the message of a failure ("config.yaml:12").
  /// Unknown key, wrong type and value out of range are errors that name the allowed ones.
  Result<void> set(std::string_view key, std::string_view text, std::string_view source);

  /// Sets options from "key=value" as given on the command line.
  Result<void> set_assignment(std::string_view assignment, std::string_view source);

  /// Reads a YAML file of nested maps; the first offending line is the error.
  Result<void> load_yaml(const std::filesystem::path& file);

  /// Current values as YAML, in the order of description, a comment on each line.
  std::string to_yaml() const;

  const std::vector<Option>& options() const { return options_; }  ///< In the order of description.

 private:
  Option& append(std::string_view key, std::string_view sentence);
  void add_choice(std::string_view key, std::vector<std::string> choices, ChoiceTarget target,
                  std::string_view sentence);
  std::string prefix_;
  std::vector<Option> options_;
};

/// The value of an option as it is written in YAML.
std::string format_value(const Option& option);

}  // namespace ydd
