# YDD_ONEDNN_LIBRARIES: oneDNN 2 or 3 (libdnnl-dev of Debian 12 and 13), or empty; then OpenCV runs the networks, several
# times slower (docs/adr/0007-inference-back-ends.md). Debian's package configuration asks for OpenCL's
# headers, which nothing here needs, so the files are looked for themselves.
option(YDD_ONEDNN "Run networks by oneDNN where it is installed" ON)
set(YDD_ONEDNN_LIBRARIES)
find_path(YDD_DNNL_INCLUDE oneapi/dnnl/dnnl_version.h)
find_library(YDD_DNNL_LIBRARY dnnl)
if(YDD_ONEDNN AND YDD_DNNL_INCLUDE AND YDD_DNNL_LIBRARY)
  file(STRINGS ${YDD_DNNL_INCLUDE}/oneapi/dnnl/dnnl_version.h version REGEX "VERSION_M(AJOR|INOR) ")
  string(REGEX REPLACE ".*MAJOR ([0-9]+).*MINOR ([0-9]+).*" "\\1.\\2" version "${version}")
  if(version VERSION_GREATER_EQUAL 2.6 AND version VERSION_LESS 4)
    set(YDD_ONEDNN_LIBRARIES ${YDD_DNNL_LIBRARY} gomp)
  endif()
endif()
if(YDD_ONEDNN_LIBRARIES)
  message(STATUS "Networks run by oneDNN ${version}")
else()
  message(STATUS "Networks run by OpenCV: no oneDNN (install libdnnl-dev to make them quicker)")
endif()
