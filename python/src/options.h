// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "binding.h"
#include "ydd/base/options.h"

namespace ydd::python {

/// From a dictionary, nested or with dots in its keys, to keys and values as text. None: nothing.
std::vector<std::pair<std::string, std::string>> settings_from(const py::object& options);

/// Sets them; the failure names the key and what is allowed.
void set_options(const std::vector<std::pair<std::string, std::string>>& settings,
                 OptionTable& table);

}  // namespace ydd::python
