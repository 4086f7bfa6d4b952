// SPDX-License-Identifier: Apache-2.0
#include "bench/figures.h"

#include "ydd/base/files.h"
#include "ydd/base/json_text.h"

namespace ydd::app {

Result<std::string> table_and_json(std::string table, const nlohmann::ordered_json& json,
                                   const std::string& out) {
  if (!out.empty()) {
    if (auto r = write_file_atomically(out, json_text(json, 2) + "\n"); !r) return r.error();
  }
  return table;
}

}  // namespace ydd::app
