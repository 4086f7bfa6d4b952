// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/image/decode.h"

namespace ydd::fuzz {

void jpeg(std::string_view input) { expect_one_line(load_colour(file_of(input, "picture.jpg"))); }

}  // namespace ydd::fuzz
