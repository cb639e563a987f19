# In the workshop of an emulator, on the screens, until one cause is left.
add_test(NAME screens_investigation
         COMMAND ${CMAKE_SOURCE_DIR}/modules/investigation/tests/in_a_terminal $<TARGET_FILE:ecs> $<TARGET_FILE:ecs-emulator>)

# A machine that warms, from nothing to thermal rows in its unit, and eight hours of it with and without them.
add_test(NAME investigation_of_a_warm_machine
         COMMAND ${CMAKE_SOURCE_DIR}/bench/investigations ${CMAKE_BINARY_DIR} 1 11 --heat)
set_tests_properties(investigation_of_a_warm_machine PROPERTIES PASS_REGULAR_EXPRESSION
                     "right causes: 1 of 1 .*about the mean of the day's rms: .*at most 0.25 in 1 of 1")
