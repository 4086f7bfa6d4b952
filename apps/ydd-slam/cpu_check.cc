// SPDX-License-Identifier: Apache-2.0
//
// Says one clear line when the processor is older than what this binary was built for, instead of
// dying of an illegal instruction (docs/adr/0004-processor-baseline.md).
//
// It runs as the first constructor of the binary and not as the first line of main(): main() and
// the constructors of global objects are themselves compiled for the new processor and may fail
// before they get there. For the same reason CMakeLists.txt compiles this file for plain x86-64,
// and it includes nothing whose inline functions another file could supply in a newer flavour.
#ifdef YDD_REQUIRED_X86_64_LEVEL

#include <unistd.h>

namespace {

constexpr int kInputFailure = 1;

template <int length>
void say(const char (&text)[length]) {
  if (write(STDERR_FILENO, text, length - 1) < 0) _exit(kInputFailure);
}

__attribute__((constructor(101))) void require_processor() {
  __builtin_cpu_init();
#if YDD_REQUIRED_X86_64_LEVEL == 3
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
      __builtin_cpu_supports("bmi2")) {
    return;
  }
  say("error: this ydd-slam was built for x86-64-v3 processors and this one lacks AVX2, FMA or "
      "BMI2");
#else
  if (__builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("ssse3") &&
      __builtin_cpu_supports("popcnt")) {
    return;
  }
  say("error: this ydd-slam was built for x86-64-v2 processors and this one lacks SSE4.2 or "
      "POPCNT");
#endif
  say("; build it here with 'cmake --preset release -DYDD_MARCH=x86-64'\n");
  _exit(kInputFailure);
}

}  // namespace

#endif
