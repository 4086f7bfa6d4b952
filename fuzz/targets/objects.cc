// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/detection/object_catalogue.h"

namespace ydd::fuzz {

void objects(std::string_view input) {
  const auto catalogue = ObjectCatalogue::parse(std::string(input), "input");
  expect_one_line(catalogue);
  if (!catalogue) return;
  for (const auto& [name, what] : catalogue->classes()) {
    const double extent_m = catalogue->extent_m(name);
    if (!(extent_m >= 0 && extent_m <= 20)) broken("an extent that cannot be");
  }
}

}  // namespace ydd::fuzz
