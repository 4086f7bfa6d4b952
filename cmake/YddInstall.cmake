# cmake --install and find_package(ydd-slam): the rooms as ydd::<room>, headers under include/ydd.
# Components: runtime, video, development, python, and ros1, which is in no package.
include(CMakePackageConfigHelpers)
get_property(rooms GLOBAL PROPERTY YDD_ROOMS)
install(TARGETS ydd_flags ${rooms} EXPORT ydd-slam-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(TARGETS ydd-slam RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(DIRECTORY src/ydd DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        FILES_MATCHING PATTERN "*.h" PATTERN "*_testing.h" EXCLUDE)
install(DIRECTORY configs models DESTINATION ${CMAKE_INSTALL_DATADIR}/ydd-slam COMPONENT runtime)
install(FILES packaging/ydd-slam.bash RENAME ydd-slam COMPONENT runtime
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
if(YDD_HAS_WINDOW)
  install(FILES packaging/ydd-slam.desktop COMPONENT runtime
          DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
endif()
include(YddManuals)
install(EXPORT ydd-slam-targets NAMESPACE ydd:: FILE ydd-slam-targets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ydd-slam COMPONENT development)
configure_package_config_file(cmake/ydd-slam-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ydd-slam)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config-version.cmake
              cmake/YddSharedCeres.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ydd-slam COMPONENT development)
