# A fleet on many hosts by what Debian has for that, on this one; skipped where GNU parallel or Slurm is missing or cannot start.
foreach(recipe parallel slurm)
  add_test(NAME fleet_${recipe}
           COMMAND tests/fleet/${recipe} $<TARGET_FILE:ecs> $<TARGET_FILE:ecs-emulator> ${CMAKE_BINARY_DIR}/fleet/${recipe}
           WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(fleet_${recipe} PROPERTIES SKIP_RETURN_CODE 77 COST 20)
endforeach()
