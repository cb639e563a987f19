# Every sample through the page in a browser, beside the native program; skipped without emscripten or chromium.
add_test(NAME page COMMAND modules/page/tests/compared $<TARGET_FILE:ecs> WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(page PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 3600 COST 200 PROCESSORS 2)
