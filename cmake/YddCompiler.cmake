# Language, warnings, sanitizers and the processor baseline, for every target alike.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(YDD_UNITY)
  # What a file needs it includes itself all the same: the presets dev and tidy compile one by one.
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)
endif()

find_program(YDD_CCACHE ccache)
if(YDD_CCACHE)
  # A precompiled header is part of the key only when ccache is told how to read it.
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${YDD_CCACHE})
endif()

add_library(ydd_flags INTERFACE)
add_library(ydd::flags ALIAS ydd_flags)
set_target_properties(ydd_flags PROPERTIES EXPORT_NAME flags)
target_compile_features(ydd_flags INTERFACE cxx_std_20)
# One Eigen layout for the library and for whoever links it, whatever their -march
# (docs/adr/0004-processor-baseline.md). With AVX, fixed-size types are aligned to 32 bytes anyway.
target_compile_definitions(ydd_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=32
  $<INSTALL_INTERFACE:EIGEN_MAX_STATIC_ALIGN_BYTES=32>)
if(NOT YDD_MARCH MATCHES "x86-64-v[34]")
  target_compile_definitions(ydd_flags INTERFACE
    $<BUILD_INTERFACE:EIGEN_MAX_STATIC_ALIGN_BYTES=32>)
endif()

add_library(ydd_build_flags INTERFACE) # not exported
target_compile_options(ydd_build_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
  -Woverloaded-virtual -Wnull-dereference -Werror -fno-math-errno)
# The libraries go into shared ones too (the Python module). Hidden names cost nothing there: calls
# between files are as direct as in a program.
target_compile_options(ydd_build_flags INTERFACE -fPIC -fvisibility=hidden)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(ydd_build_flags INTERFACE -fpch-preprocess)
  # GCC 12 reports false positives from inlined standard and Eigen code at -O2 and above.
  target_compile_options(ydd_build_flags INTERFACE
    -Wno-error=null-dereference -Wno-null-dereference -Wno-error=maybe-uninitialized
    -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-restrict)
endif()
if(YDD_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A struct of a .cc file may hold what its anonymous namespace defines; unity hides whose it is.
  target_compile_options(ydd_build_flags INTERFACE -Wno-subobject-linkage)
endif()
# Tests wait for the library's code, not for their own: -O3 doubles the time that they compile.
add_library(ydd_test_flags INTERFACE) # not exported
target_compile_options(ydd_test_flags INTERFACE $<$<CONFIG:Release>:-O1>)
if(YDD_MARCH AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(ydd_build_flags INTERFACE -march=${YDD_MARCH})
endif()
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # x86-64-v2 has no fused multiplication and addition, other processors have, and compilers use it
  # where they like: the same sum comes out otherwise. Products and sums stay what they are written as.
  target_compile_options(ydd_build_flags INTERFACE -ffp-contract=off)
endif()
if(YDD_SANITIZE)
  target_compile_options(ydd_build_flags INTERFACE -fsanitize=${YDD_SANITIZE}
    -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(ydd_build_flags INTERFACE -fsanitize=${YDD_SANITIZE})
endif()
