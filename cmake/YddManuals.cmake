# Manual pages made of --help (help2man), one for the program and one for each sub-command:
# ydd-slam(1), ydd-slam-run(1), ... Without help2man there are none.
find_program(YDD_HELP2MAN help2man)
if(NOT YDD_HELP2MAN OR CMAKE_CROSSCOMPILING OR YDD_SANITIZE)
  return()
endif()
file(GLOB commands CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/apps/ydd-slam
     apps/ydd-slam/*_command.cc)
set(man ${CMAKE_CURRENT_BINARY_DIR}/man)
file(MAKE_DIRECTORY ${man})
set(pages)
foreach(command "" ${commands})
  string(REGEX REPLACE "_command.cc$" "" command "${command}")
  if(command STREQUAL "")
    set(page ${man}/ydd-slam.1)
    set(name "visual RGB-D SLAM that keeps its bearings among moving people")
  else()
    set(page ${man}/ydd-slam-${command}.1)
    set(name "see ydd-slam(1)")
  endif()
  add_custom_command(OUTPUT ${page} DEPENDS ydd-slam ${CMAKE_CURRENT_SOURCE_DIR}/tools/make-manual
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/make-manual $<TARGET_FILE:ydd-slam> ${page} ${command}
    VERBATIM)
  list(APPEND pages ${page})
endforeach()
add_custom_target(ydd_manuals ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
