# How a room becomes a library, a program or a test.

add_library(ecs_flags INTERFACE)
target_compile_options(ecs_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
                       -Wnon-virtual-dtor -Wold-style-cast -Werror)
# GCC 12 warns of overlaps in std::string's own operator+ at -O3 where there are none (its bug 105651).
target_compile_options(ecs_flags INTERFACE
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
target_include_directories(ecs_flags INTERFACE ${CMAKE_SOURCE_DIR})

# ecs_room(name LINKS targets...): every .cpp of the folder but main.cpp, as library `name`.
function(ecs_room name)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  if(NOT sources)
    add_library(${name} INTERFACE)
    return()
  endif()
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC ecs_flags ${ARG_LINKS})
endfunction()

# ecs_tests(room LINKS targets...): tests/<room>/*_test.cpp as one program `<room>_tests`, registered with CTest.
function(ecs_tests room)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${room}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${room}_tests ${sources})
  target_link_libraries(${room}_tests PRIVATE ecs_test_main ${ARG_LINKS})
  add_test(NAME ${room} COMMAND ${room}_tests WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
endfunction()
