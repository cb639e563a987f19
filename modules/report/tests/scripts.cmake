# The report of the mill as another parser and a browser see it; skipped without chromium.
add_test(NAME report_prints
         COMMAND modules/report/tests/prints ${CMAKE_BINARY_DIR}/commission/mill/report.html ${CMAKE_BINARY_DIR}/report_pages
                 "measurements with a limit are within it"
         WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(report_prints PROPERTIES FIXTURES_REQUIRED commissioned_mill SKIP_RETURN_CODE 77)
