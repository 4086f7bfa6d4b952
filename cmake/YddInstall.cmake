# cmake --install and find_package(ydd-slam): the rooms as ydd::<room>, headers under include/ydd.
include(CMakePackageConfigHelpers)
get_property(rooms GLOBAL PROPERTY YDD_ROOMS)
install(TARGETS ydd_flags ${rooms} EXPORT ydd-slam-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS ydd-slam RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY src/ydd DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING
        PATTERN "*.h" PATTERN "*_testing.h" EXCLUDE)
install(DIRECTORY configs models DESTINATION ${CMAKE_INSTALL_DATADIR}/ydd-slam)
install(EXPORT ydd-slam-targets NAMESPACE ydd:: FILE ydd-slam-targets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ydd-slam)
configure_package_config_file(cmake/ydd-slam-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ydd-slam)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/ydd-slam-config-version.cmake
              cmake/YddSharedCeres.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ydd-slam)
