# `make package`: Debian packages ydd-slam, ydd-slam-dev, python3-ydd-slam and ydd-slam-video, with
# the dependencies that dpkg-shlibdeps finds. What encodes videos is one of its own: OpenCV's video
# back end brings 190 packages with it, as much again as all the rest.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ydd-slam)
set(CPACK_PACKAGE_VENDOR ydd-slam)
set(CPACK_PACKAGE_CONTACT "ydd-slam <ydd-slam@localhost>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_OUTPUT_FILE_PREFIX packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_DEBUGINFO_PACKAGE OFF)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME ydd-slam)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "From colour and depth it computes where the camera went and a map of what
stands still.
People may fill half the picture: only the points on them are left out. With
a network that finds them, a window, a web page and maps that last.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS fonts-dejavu-core)
# Loaded when a map has a key; without it the program says so.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "libsqlcipher0 | libsqlcipher1")
if(TARGET ydd_video)
  list(APPEND CPACK_COMPONENTS_ALL video)
  string(APPEND CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS ", ydd-slam-video (= ${PROJECT_VERSION})")
  set(CPACK_DEBIAN_VIDEO_PACKAGE_NAME ydd-slam-video)
  set(CPACK_DEBIAN_VIDEO_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_VIDEO_PACKAGE_DEPENDS "ydd-slam (= ${PROJECT_VERSION})")
  set(CPACK_COMPONENT_VIDEO_DESCRIPTION "Videos of runs
What `ydd-slam run --video` needs besides.")
endif()

# What find_package(ydd-slam) looks for; the list is that of tools/install-deps.
execute_process(COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/install-deps --libraries
                OUTPUT_VARIABLE libraries OUTPUT_STRIP_TRAILING_WHITESPACE)
string(REPLACE "\n" ", " libraries "${libraries}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME ydd-slam-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${libraries}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Static libraries and headers for C++20.
find_package(ydd-slam) gives them as ydd::system, ydd::robot and so on.")

if(YDD_HAS_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  math(EXPR next "${YDD_PYTHON_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-ydd-slam)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "ydd-slam (= ${PROJECT_VERSION}), python3-numpy, python3 (>= 3.${YDD_PYTHON_MINOR}), python3 (<< 3.${next})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
      "${CMAKE_CURRENT_SOURCE_DIR}/packaging/postinst;${CMAKE_CURRENT_SOURCE_DIR}/packaging/prerm")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Module of Python
Pictures in, poses, points and maps out as NumPy arrays; detectors and masks
of one's own.")
endif()

# Everything that goes into them, and no tests.
add_custom_target(ydd_packaged DEPENDS ydd-slam)
get_property(rooms GLOBAL PROPERTY YDD_ROOMS)
foreach(target IN LISTS rooms ITEMS ydd_video ydd_python ydd_manuals)
  if(TARGET ${target})
    add_dependencies(ydd_packaged ${target})
  endif()
endforeach()
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} COMPONENT)
  install(FILES packaging/copyright COMPONENT ${component}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME})
endforeach()
include(CPack)
