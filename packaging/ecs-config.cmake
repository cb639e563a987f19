# find_package(ecs): the target ecs::ecs, core and error model of ECS as one static library.
include(CMakeFindDependencyMacro)
find_dependency(fmt)
find_dependency(tl-expected)
find_dependency(Threads)
if(NOT TARGET ecs::ecs)
  get_filename_component(ecs_libraries "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
  find_path(ECS_INCLUDE_DIR ecs/core/terms.hpp)
  find_path(ECS_EIGEN_INCLUDE_DIR Eigen/Core PATH_SUFFIXES eigen3)
  mark_as_advanced(ECS_INCLUDE_DIR ECS_EIGEN_INCLUDE_DIR)
  add_library(ecs::ecs STATIC IMPORTED)
  set_target_properties(ecs::ecs PROPERTIES
    IMPORTED_LOCATION "${ecs_libraries}/libecs.a"
    INTERFACE_INCLUDE_DIRECTORIES "${ECS_INCLUDE_DIR}/ecs;${ECS_EIGEN_INCLUDE_DIR}"
    INTERFACE_COMPILE_FEATURES cxx_std_20
    INTERFACE_LINK_LIBRARIES "fmt::fmt;tl::expected;Threads::Threads;nettle;muparser;tomlplusplus;z")
endif()
