// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/base/yaml_reader.h"

namespace ydd::fuzz {

void yaml(std::string_view input) { expect_one_line(parse_yaml(std::string(input), "input")); }

}  // namespace ydd::fuzz
