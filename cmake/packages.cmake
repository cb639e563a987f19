# What `cmake --install` puts where, and the three Debian packages that scripts/package makes of it.
include(GNUInstallDirs)

# --- ecs: the program, samples, manual pages, completions
install(TARGETS ecs RUNTIME COMPONENT ecs)
install(DIRECTORY samples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/ecs/samples COMPONENT ecs USE_SOURCE_PERMISSIONS)

# --- ecs-emulator: the virtual workshop, and a service that keeps one running
install(TARGETS ecs-emulator RUNTIME COMPONENT ecs-emulator)
install(FILES packaging/ecs-emulator.service DESTINATION lib/systemd/system COMPONENT ecs-emulator)

# Manual pages and completions are written by the programs themselves: cmake --build … --target documents.
foreach(program ecs ecs-emulator)
  set(pages ${CMAKE_CURRENT_BINARY_DIR}/documents/${program})
  add_custom_command(OUTPUT ${pages}/written
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${pages}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${pages}
    COMMAND ${program} manual -o ${pages}/man
    COMMAND ${CMAKE_SOURCE_DIR}/packaging/completions ${pages} ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:${program}>
    COMMAND ${CMAKE_COMMAND} -E touch ${pages}/written
    DEPENDS ${program} ${CMAKE_SOURCE_DIR}/packaging/completions VERBATIM)
  list(APPEND written ${pages}/written)
  install(DIRECTORY ${pages}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${program} OPTIONAL)
  install(FILES ${pages}/bash RENAME ${program} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          COMPONENT ${program} OPTIONAL)
  install(FILES ${pages}/zsh RENAME _${program} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
          COMPONENT ${program} OPTIONAL)
  install(FILES ${pages}/fish RENAME ${program}.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
          COMPONENT ${program} OPTIONAL)
endforeach()
add_custom_target(documents DEPENDS ${written})

# --- libecs-dev: core and model as one library, with the folders that their headers need
set(folders base base/linear core kinematics params laser/analysis laser/import laser/map laser/standards laser/writers laser model/data
            model/effects model/regression model/fit model/diagnosis model/planning)
foreach(folder IN LISTS folders)
  string(REPLACE "/" "_" name ${folder})
  if(TARGET ${name})
    get_target_property(type ${name} TYPE)
    if(type STREQUAL STATIC_LIBRARY)
      list(APPEND objects $<TARGET_OBJECTS:${name}>)
    endif()
  endif()
  file(GLOB headers ${CMAKE_SOURCE_DIR}/${folder}/*.hpp)
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ecs/${folder} COMPONENT dev EXCLUDE_FROM_ALL)
endforeach()
add_library(ecs_library STATIC EXCLUDE_FROM_ALL ${objects})
set_target_properties(ecs_library PROPERTIES OUTPUT_NAME ecs LINKER_LANGUAGE CXX)
install(FILES $<TARGET_FILE:ecs_library> DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev EXCLUDE_FROM_ALL)
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/ecs-config-version.cmake COMPATIBILITY ExactVersion)
install(FILES packaging/ecs-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/ecs-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ecs COMPONENT dev EXCLUDE_FROM_ALL)
install(DIRECTORY packaging/example DESTINATION ${CMAKE_INSTALL_DOCDIR}/../libecs-dev/examples COMPONENT dev
        EXCLUDE_FROM_ALL)

# --- Debian packages, by scripts/package: one for each component
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ecs)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The ECS authors <ecs@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL ecs ecs-emulator dev)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_ECS_PACKAGE_NAME ecs)
set(CPACK_DEBIAN_ECS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_ECS_PACKAGE_RECOMMENDS "ecs-emulator, gnuplot-nox")
set(CPACK_DEBIAN_ECS_DESCRIPTION "commissioning of error compensation systems for machine tools
Parameters, on-line monitor, laser measurements, error maps and error models
of machine tools whose position errors a unit between control and drives
cancels. Terminal screens and verbs for scripts; Modbus RTU and TCP.")
set(CPACK_DEBIAN_ECS-EMULATOR_PACKAGE_NAME ecs-emulator)
set(CPACK_DEBIAN_ECS-EMULATOR_PACKAGE_SECTION science)
set(CPACK_DEBIAN_ECS-EMULATOR_PACKAGE_SUGGESTS "libunicorn2")  # runs user software; GPL-2, loaded where it is installed
set(CPACK_DEBIAN_ECS-EMULATOR_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/packaging/ecs-emulator.control/prerm
    ${CMAKE_SOURCE_DIR}/packaging/ecs-emulator.control/postrm)
set(CPACK_DEBIAN_ECS-EMULATOR_DESCRIPTION "emulated error compensation unit with its machine tool
A unit at the end of a Modbus line, the machine that it compensates and the
instruments that measure it, with the same compensation core as the unit.")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libecs-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libfmt-dev, libexpected-dev, libeigen3-dev, nettle-dev, libmuparser-dev, zlib1g-dev, libtomlplusplus-dev")
set(CPACK_DEBIAN_DEV_DESCRIPTION "compensation core and error models of machine tools, for programs
One static library with headers: tables of compensation, measurement files,
maps, and the fit and diagnosis of error models. find_package(ecs).")
foreach(component ecs ecs-emulator dev)
  string(TOUPPER ${component} upper)
  set(name ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/documents/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
include(CPack)
