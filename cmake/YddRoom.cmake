# Precompiled headers: one for all targets, and one for all tests.
if(YDD_PCH)
  file(WRITE ${CMAKE_BINARY_DIR}/pch.cc "")
  foreach(pch ydd_pch ydd_test_pch)
    add_library(${pch} STATIC ${CMAKE_BINARY_DIR}/pch.cc)
    target_link_libraries(${pch} PRIVATE ydd::flags ydd_build_flags Eigen3::Eigen fmt::fmt
                                         Threads::Threads)
    target_precompile_headers(${pch} PRIVATE
      <algorithm> <array> <cmath> <filesystem> <memory> <optional> <string> <vector>
      <Eigen/Core> <Eigen/Geometry> <fmt/format.h>)
  endforeach()
  if(YDD_BUILD_TESTS)
    target_link_libraries(ydd_test_pch PRIVATE ydd_test_flags GTest::gmock
                                               nlohmann_json::nlohmann_json)
    target_precompile_headers(ydd_test_pch PRIVATE <gmock/gmock.h> <gtest/gtest.h>
                                                   <nlohmann/json.hpp>)
  endif()
endif()
function(ydd_precompile target pch)
  if(YDD_PCH)
    target_precompile_headers(${target} REUSE_FROM ${pch})
  endif()
endfunction()

# ydd_room(<name> [ROOMS <room>...] [PUBLIC <lib>...] [PRIVATE <lib>...])
#
# One folder, one target ydd::<name>. Sources are all *.cc of the folder; *_test.cc beside them
# become the test program ydd_<name>_test. ROOMS may only name rooms above this one in
# src/ydd/CMakeLists.txt (tools/check-architecture holds that against the includes too).
function(ydd_room name)
  cmake_parse_arguments(ROOM "" "" "ROOMS;PUBLIC;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cc)
  file(GLOB headers CONFIGURE_DEPENDS *.h)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cc$")
  list(FILTER tests INCLUDE REGEX "_test\\.cc$")
  list(TRANSFORM ROOM_ROOMS PREPEND ydd::)
  if(sources)
    add_library(ydd_${name} STATIC ${sources})
    target_link_libraries(ydd_${name} PUBLIC ydd::flags ${ROOM_ROOMS} ${ROOM_PUBLIC}
                                      PRIVATE ${ROOM_PRIVATE} $<BUILD_INTERFACE:ydd_build_flags>)
    target_include_directories(ydd_${name} PUBLIC
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
    ydd_precompile(ydd_${name} ydd_pch)
  else()
    add_library(ydd_${name} INTERFACE)
    target_link_libraries(ydd_${name} INTERFACE ydd::flags ${ROOM_ROOMS} ${ROOM_PUBLIC})
    target_include_directories(ydd_${name} INTERFACE
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
  endif()
  add_library(ydd::${name} ALIAS ydd_${name})
  set_target_properties(ydd_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY YDD_ROOMS ydd_${name})
  if(YDD_BUILD_TESTS AND tests)
    add_executable(ydd_${name}_test ${tests})
    target_link_libraries(ydd_${name}_test PRIVATE ydd::${name} ${ROOM_PRIVATE} ydd_build_flags
                                                   ydd_test_flags GTest::gmock GTest::gtest_main)
    target_compile_definitions(ydd_${name}_test PRIVATE
      YDD_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    ydd_precompile(ydd_${name}_test ydd_test_pch)
    gtest_discover_tests(ydd_${name}_test TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 120
                         PROPERTIES LABELS "quick" TIMEOUT 300)
  endif()
endfunction()
