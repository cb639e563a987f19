# ecs_commit(INTO FOLDER): the commit of these sources, seven digits; empty where nobody knows it. A checkout asks git; in an
# archive that git has made it stands in base/archived_commit (.gitattributes). A repository around FOLDER is another one.
function(ecs_commit into folder)
  set(commit "")
  if(EXISTS ${folder}/.git)
    execute_process(COMMAND git describe --always --exclude=* --abbrev=7 WORKING_DIRECTORY ${folder}
                    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed EQUAL 0)
      set(commit "")
    endif()
  elseif(EXISTS ${folder}/base/archived_commit)
    file(READ ${folder}/base/archived_commit stated)
    string(REGEX MATCH "^[0-9a-f]+" commit "${stated}")
    string(SUBSTRING "${commit}" 0 7 commit)
  endif()
  set(${into} "${commit}" PARENT_SCOPE)
endfunction()

# ecs_version(TARGET FOLDER): compiles base/version.cpp, which states version and commit, into TARGET. Configured again after
# every commit; only this file is compiled again.
function(ecs_version target folder)
  ecs_commit(ECS_COMMIT ${folder})
  if(ECS_COMMIT)
    set(ECS_COMMIT " (${ECS_COMMIT})")
  endif()
  if(EXISTS ${folder}/.git/logs/HEAD)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/.git/logs/HEAD)
  endif()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/base/version.cpp)
  configure_file(${folder}/base/version.cpp.in ${source} @ONLY)
  target_sources(${target} PRIVATE ${source})
  set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
