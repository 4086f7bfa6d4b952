// SPDX-License-Identifier: Apache-2.0
#include "options.h"

namespace ydd::python {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

std::string text_of_value(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  return py::str(value).cast<std::string>();
}

void add_settings(const std::string& prefix, const py::dict& options, Settings& out) {
  for (const auto& [key, value] : options) {
    if (!py::isinstance<py::str>(key)) throw Failure("options: a key must be a string");
    const std::string name = prefix + key.cast<std::string>();
    if (py::isinstance<py::dict>(value)) {
      add_settings(name + ".", value.cast<py::dict>(), out);
    } else {
      out.emplace_back(name, text_of_value(value));
    }
  }
}

}  // namespace

Settings settings_from(const py::object& options) {
  Settings out;
  if (options.is_none()) return out;
  if (!py::isinstance<py::dict>(options)) {
    throw Failure("options: must be a dictionary; a file is given as config");
  }
  add_settings("", options.cast<py::dict>(), out);
  return out;
}

void set_options(const Settings& settings, OptionTable& table) {
  for (const auto& [key, text] : settings) value_of(table.set(key, text, "options"));
}

}  // namespace ydd::python
