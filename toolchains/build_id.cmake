# octoskin_build_id(<target>): defines OCTOSKIN_BUILD_ID, the build that NODE_INFO reports: the first 32 bits of the
# commit, or 0 without one. A new commit makes CMake configure again.
function(octoskin_build_id target)
    execute_process(COMMAND git rev-parse --short=8 HEAD WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
        OUTPUT_VARIABLE build_id OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND git rev-parse --path-format=absolute --git-path logs/HEAD
        WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE git_log OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(build_id MATCHES "^[0-9a-f]+$" AND EXISTS "${git_log}")
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${git_log})
        string(SUBSTRING ${build_id} 0 8 build_id)
    else()
        set(build_id 0)
    endif()
    target_compile_definitions(${target} PRIVATE OCTOSKIN_BUILD_ID=0x${build_id}U)
endfunction()
