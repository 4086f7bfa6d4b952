// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "support.h"
#include "targets.h"
#include "ydd/base/json_reader.h"

namespace ydd::fuzz {

void json(std::string_view input) { expect_one_line(parse_json(input, "input")); }

}  // namespace ydd::fuzz
