# Makes Ceres::ceres the shared library. Debian's package configuration names the static one, and that
# mixes two compilations of Eigen in one binary: Ceres' own (16-byte alignment, malloc) and ours (AVX,
# see docs/adr/0004-processor-baseline.md). Their inline functions have the same names, the linker keeps
# one of each, and memory allocated by one may be freed by the other. The shared library keeps its
# own to itself.
find_library(YDD_SHARED_CERES NAMES libceres.so)
if(YDD_SHARED_CERES AND TARGET Ceres::ceres)
  get_target_property(ydd_ceres_configs Ceres::ceres IMPORTED_CONFIGURATIONS)
  foreach(config IN LISTS ydd_ceres_configs)
    set_target_properties(Ceres::ceres PROPERTIES IMPORTED_LOCATION_${config} ${YDD_SHARED_CERES})
  endforeach()
  # What Ceres' headers need; what the static archive needed is the shared library's business.
  set_target_properties(Ceres::ceres PROPERTIES
    INTERFACE_LINK_LIBRARIES "Threads::Threads;glog::glog;Eigen3::Eigen")
endif()
