// SPDX-License-Identifier: Apache-2.0
//
// Between libFuzzer and one of the targets: YDD_FUZZ_TARGET names it.
#include <cstddef>
#include <cstdint>

#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ydd::fuzz::YDD_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
