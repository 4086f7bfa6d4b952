# Everything comes from the distribution (tools/install-deps names the packages).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc features2d calib3d video dnn)
find_package(OpenCV QUIET OPTIONAL_COMPONENTS videoio)  # of --video alone
find_package(Ceres REQUIRED)
include(YddSharedCeres)
find_package(TBB REQUIRED)
include(YddOneDnn)
find_package(CLI11 REQUIRED)
find_package(SQLite3 REQUIRED)
# Draws the plots of reports; embedded in the programme.
find_file(YDD_DYGRAPHS_JS dygraph.min.js PATHS /usr/share/javascript/dygraphs NO_DEFAULT_PATH
          REQUIRED)
find_file(YDD_DYGRAPHS_CSS dygraph.min.css PATHS /usr/share/javascript/dygraphs NO_DEFAULT_PATH
          REQUIRED)
if(YDD_BUILD_SIMULATION)
  find_package(embree 3 REQUIRED)
endif()
if(YDD_BUILD_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
  if(YDD_SANITIZE)
    # Sanitized programmes list their tests when ctest runs, with the options that it is given.
    set(CMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE PRE_TEST)
  endif()
endif()
if(YDD_BUILD_BENCH)
  find_package(benchmark REQUIRED)
endif()
