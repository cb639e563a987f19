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
target_include_directories(ecs_flags INTERFACE ${CMAKE_SOURCE_DIR})

set(ECS_SOURCES_A_UNIT 10 CACHE STRING "Sources of a folder that are compiled as one unit; 1 compiles each by itself")

# The library of a folder is named after its path: model/fit is model_fit.
function(ecs_folder_name result)
  file(RELATIVE_PATH path ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REPLACE "/" "_" name ${path})
  set(${result} ${name} PARENT_SCOPE)
endfunction()

# ecs_library(LINKS targets...): every .cpp of this folder but main.cpp, as the library of that name. LINKS is what the
# folder may include; scripts/check_includes holds it to that.
function(ecs_library)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  ecs_folder_name(name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  set_property(GLOBAL APPEND PROPERTY ecs_libraries ${name})
  if(sources)
    add_library(${name} STATIC ${sources})
    target_link_libraries(${name} PUBLIC ecs_flags ${ARG_LINKS})
    # The sources of a folder are compiled together: most of the time of a build goes into the headers they share.
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ECS_SOURCES_A_UNIT})
    if(name MATCHES "^(core|model|volume)")
      target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3>)
    elseif(name MATCHES "^(app_(cli|plot|report|verbs)|base_cli|commissioning)")
      # What waits for a person, a file or a link; a quarter of its compile time went into optimising it.
      target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE ecs_flags ${ARG_LINKS})
  endif()
endfunction()
