# In the workshop of an emulator, on the screens, until one cause is left.
add_test(NAME screens_investigation
         COMMAND ${CMAKE_SOURCE_DIR}/modules/investigation/tests/in_a_terminal $<TARGET_FILE:ecs> $<TARGET_FILE:ecs-emulator>)
set_tests_properties(screens_investigation PROPERTIES TIMEOUT 600)
