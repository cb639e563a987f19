# The real LinuxCNC with exported tables: what it adds, position by position, against the map.
add_test(NAME linuxcnc
         COMMAND scripts/linuxcnc_check ${CMAKE_BINARY_DIR}/linuxcnc ${CMAKE_BINARY_DIR}
         WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(linuxcnc PROPERTIES SKIP_RETURN_CODE 77 PROCESSORS 2 COST 50)
