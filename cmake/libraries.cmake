# How a folder becomes a library, a program or a test.

add_library(ecs_flags INTERFACE)
target_compile_options(ecs_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
                       -Wnon-virtual-dtor -Wold-style-cast -Werror)
if(CMAKE_CXX_FLAGS MATCHES "sanitize")  # g++ warns of the conversions of its own instrumentation
  target_compile_options(ecs_flags INTERFACE -Wno-error)
endif()
# GCC 12 warns of overlaps in std::string's own operator+ at -O3 where there are none (its bug 105651).
target_compile_options(ecs_flags INTERFACE
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
# The same bits on every processor. One rounding an operation: g++ fuses a*b + c where the processor can, as on arm64 and, with -march, on
# x86-64. Matrix products in the same order: Eigen would choose it by the caches of the processor.
target_compile_options(ecs_flags INTERFACE -ffp-contract=off)
target_compile_definitions(ecs_flags INTERFACE EIGEN_NO_CPUID EIGEN_DEFAULT_L1_CACHE_SIZE=32768 EIGEN_DEFAULT_L2_CACHE_SIZE=262144
                           EIGEN_DEFAULT_L3_CACHE_SIZE=2097152)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  target_compile_options(ecs_flags INTERFACE -include ${CMAKE_SOURCE_DIR}/cmake/eigen_as_on_amd64.hpp)
endif()
target_include_directories(ecs_flags INTERFACE ${CMAKE_SOURCE_DIR})

set(ECS_SOURCES_A_UNIT 10 CACHE STRING "Sources of a folder that are compiled as one unit; 1 compiles each on its own")

# ecs_folder(folder links...): every .cpp of the folder but main.cpp, as a library named after its path (model/fit is
# model_fit). The links are what the folder may include: folders by their path, packages by their target.
function(ecs_folder folder)
  string(REPLACE "/" "_" name ${folder})
  set(links)
  foreach(link IN LISTS ARGN)
    if(NOT link MATCHES "::")
      string(REPLACE "/" "_" link ${link})
    endif()
    list(APPEND links ${link})
  endforeach()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${folder}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  set_property(GLOBAL APPEND PROPERTY ecs_libraries ${name})
  if(sources)
    add_library(${name} STATIC ${sources})
    target_link_libraries(${name} PUBLIC ecs_flags ${links})
    # The sources of a folder are compiled together: most of the time of a build goes into the headers they share.
    # Those whose matrices would take the compiler more than 1 GB are parted in three.
    set(together ${ECS_SOURCES_A_UNIT})
    if(name MATCHES "^(model_(diagnosis|fit)|modules_(lengths|standards))$")
      list(LENGTH sources third)
      math(EXPR third "(${third} + 2) / 3")
      if(together GREATER third)
        set(together ${third})
      endif()
    endif()
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${together})
    if(name MATCHES "^(core|model|volume|modules_(lengths|standards))")
      target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3>)
    elseif(name MATCHES "^(app_(cli|plot|verbs)|base_cli|commissioning|modules_(capture|controllers|fleet|investigation|logbook|report))")
      # What waits for a person, a file or a link; a quarter of its compile time went into optimising it.
      target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE ecs_flags ${links})
  endif()
endfunction()
