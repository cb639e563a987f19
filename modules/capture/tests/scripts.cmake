# Three bidirectional runs with a fake trigger and a fake thermometer, one pulled out in between, on to map and upload.
add_test(NAME capture_session
         COMMAND scripts/capture_session ${CMAKE_BINARY_DIR}/capture_session ${CMAKE_BINARY_DIR}
         WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(capture_session PROPERTIES RESOURCE_LOCK umockdev-wrapper
                     ENVIRONMENT "ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0")
