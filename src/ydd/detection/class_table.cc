// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/class_table.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/yaml_reader.h"

namespace ydd {
namespace {

/// An entry with its number, before the numbers are checked.
struct Numbered {
  int index = 0;
  std::string name;
  int line = 0;
};

Result<std::vector<Numbered>> numbered_names(const YAML::Node& names, const std::string& file) {
  std::vector<Numbered> out;
  const auto add = [&](int index, const YAML::Node& name) -> Result<void> {
    const int line = name.Mark().line + 1;
    if (!name.IsScalar() || name.Scalar().empty()) {
      return Error{fmt::format("{}:{}: a class name must be text", file, line)};
    }
    out.push_back({index, name.Scalar(), line});
    return {};
  };
  if (names.IsSequence()) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (auto added = add(static_cast<int>(i), names[i]); !added) return added.error();
    }
    return out;
  }
  for (const auto& entry : names) {
    int index = -1;
    if (!YAML::convert<int>::decode(entry.first, index)) {
      return Error{fmt::format("{}:{}: a class number must be 0, 1, 2, ...", file,
                               entry.first.Mark().line + 1)};
    }
    if (auto added = add(index, entry.second); !added) return added.error();
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Numbered& a, const Numbered& b) { return a.index < b.index; });
  return out;
}

Result<std::vector<std::string>> parse_class_table(const YAML::Node& root,
                                                   const std::string& file) {
  const YAML::Node names = root.IsMap() ? root["names"] : YAML::Node(YAML::NodeType::Undefined);
  if (!names || !(names.IsSequence() || names.IsMap()) || names.size() == 0) {
    return Error{file + ": must hold 'names: [first class, second class, ...]'"};
  }
  const auto numbered = numbered_names(names, file);
  if (!numbered) return numbered.error();
  std::vector<std::string> out;
  for (const Numbered& entry : *numbered) {
    if (entry.index != static_cast<int>(out.size())) {
      return Error{fmt::format("{}:{}: class number {} where {} was expected", file, entry.line,
                               entry.index, out.size())};
    }
    if (std::find(out.begin(), out.end(), entry.name) != out.end()) {
      return Error{fmt::format("{}:{}: class '{}' is named twice", file, entry.line,
                               on_one_line(entry.name))};
    }
    out.push_back(entry.name);
  }
  return out;
}

}  // namespace

Result<std::vector<std::string>> read_class_table(const std::filesystem::path& file) {
  const Result<YAML::Node> root = read_yaml(file);
  if (!root) return root.error();
  return parse_class_table(*root, file.string());
}

}  // namespace ydd
