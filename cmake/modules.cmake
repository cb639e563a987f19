# Subjects beside the thesis's job: modules/<name>/, each with its CMakeLists.txt. What is there is a part of the programs;
# without its folder, or named in ECS_WITHOUT, it is not, and nothing else changes (scripts/check_modules).
set(ECS_WITHOUT "" CACHE STRING "Modules to leave out, separated by semicolons")

# ecs_module(name [HOST folder] [EMULATOR folder] [NEEDS modules...]): the folders with its definition; HOST holds
# <name>_module() (app/cli/module.hpp), EMULATOR <name>_emulator_module() (ecs_emulator/verbs/module.hpp). The first line of its
# CMakeLists.txt: a module that needs one that is not there is not there either.
macro(ecs_module name)
  cmake_parse_arguments(MODULE "" "HOST;EMULATOR" "NEEDS" ${ARGN})
  foreach(other IN LISTS MODULE_NEEDS)
    if(NOT EXISTS ${CMAKE_SOURCE_DIR}/modules/${other}/CMakeLists.txt OR other IN_LIST ECS_WITHOUT)
      message(STATUS "without the module ${name}: it needs ${other}")
      return()
    endif()
  endforeach()
  list(APPEND ecs_modules ${name})
  foreach(part HOST EMULATOR)
    if(MODULE_${part})
      string(REPLACE "/" "_" ecs_${part}_of_${name} ${MODULE_${part}})
      list(APPEND ecs_${part}_modules ${name})
    endif()
  endforeach()
  set(ecs_needs_of_${name} ${MODULE_NEEDS})
endmacro()

# ecs_module_tests(LINKS targets...): its tests, modules/<name>/tests/*_test.cpp; the words are those of ecs_tests.
macro(ecs_module_tests)
  list(GET ecs_modules -1 ecs_last)
  set(ecs_tests_of_${ecs_last} ${ARGN})
endmacro()

# ecs_module_fuzzers([READERS ids... READ_WITH sources...] [TEXTS ids... WITH sources...]): what of it is fuzzed, and the sources
# of its folder, without .cpp (a written one by its whole path), with tests/*_fuzz that adds it (tests/fuzz/parsers.hpp).
macro(ecs_module_fuzzers)
  list(GET ecs_modules -1 ecs_last)
  set(ecs_fuzzers_of_${ecs_last} ${ARGN})
endmacro()

# The registry of a program as a source: those of the modules that are given.
function(ecs_module_registry file part)
  set(declared)
  set(named)
  foreach(name IN LISTS ARGN)
    if(part STREQUAL HOST)
      string(APPEND declared "const Module& ${name}_module();\n")
      list(APPEND named "&${name}_module()")
    else()
      string(APPEND declared "const Module& ${name}_emulator_module();\n")
      list(APPEND named "&${name}_emulator_module()")
    endif()
  endforeach()
  list(JOIN named ", " named)
  if(part STREQUAL HOST)
    set(header app/cli/module.hpp)
    set(namespace ecs::app)
  else()
    set(header ecs_emulator/verbs/module.hpp)
    set(namespace ecs::emulator)
  endif()
  file(CONFIGURE OUTPUT ${file} CONTENT [[#include "@header@"

namespace @namespace@ {
@declared@
const std::vector<const Module*>& modules() {
  static const std::vector<const Module*> all{@named@};
  return all;
}
}  // namespace @namespace@
]] @ONLY)
endfunction()

# The libraries ecs_modules and ecs_emulator_modules: what a program or test links that asks modules(). Libraries of objects: the
# core asks modules(), and an archive would be searched before it does.
function(ecs_module_libraries)
  foreach(part HOST EMULATOR)
    set(library ecs_modules)
    set(core app_cli)
    if(part STREQUAL EMULATOR)
      set(library ecs_emulator_modules)
      set(core ecs_emulator_verbs)
    endif()
    set(file ${CMAKE_BINARY_DIR}/modules/${library}.cpp)
    ecs_module_registry(${file} ${part} ${ecs_${part}_modules})
    add_library(${library} OBJECT ${file})
    target_link_libraries(${library} PUBLIC ${core})
    foreach(name IN LISTS ecs_${part}_modules)
      target_link_libraries(${library} PUBLIC ${ecs_${part}_of_${name}})
    endforeach()
  endforeach()
endfunction()

# For each module the program linked without it, and without those that need it: ecs_without_<name>, built when asked for.
function(ecs_programs_without program part main)
  foreach(name IN LISTS ecs_${part}_modules)
    set(left)
    foreach(other IN LISTS ecs_${part}_modules)
      if(NOT other STREQUAL name AND NOT name IN_LIST ecs_needs_of_${other})
        list(APPEND left ${other})
      endif()
    endforeach()
    set(file ${CMAKE_BINARY_DIR}/modules/${program}_without_${name}.cpp)
    ecs_module_registry(${file} ${part} ${left})
    add_executable(${program}_without_${name} EXCLUDE_FROM_ALL ${main} ${file})
    target_link_libraries(${program}_without_${name} PRIVATE ${ARGN})
    foreach(other IN LISTS left)
      target_link_libraries(${program}_without_${name} PRIVATE ${ecs_${part}_of_${other}})
    endforeach()
  endforeach()
endfunction()

file(GLOB ecs_found RELATIVE ${CMAKE_SOURCE_DIR}/modules CONFIGURE_DEPENDS modules/*/CMakeLists.txt)
list(TRANSFORM ecs_found REPLACE "/CMakeLists.txt" "")
list(SORT ecs_found)
foreach(one IN LISTS ecs_found)
  if(NOT one IN_LIST ECS_WITHOUT)
    include(modules/${one}/CMakeLists.txt)
  endif()
endforeach()
ecs_module_libraries()
