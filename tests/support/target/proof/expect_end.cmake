# Runs a program and fails unless it ends with this exit code and says this:
#   cmake -D "COMMAND=a;b;c" -D CODE=1 -D TEXT=regex -P expect_end.cmake
execute_process(COMMAND ${COMMAND} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output TIMEOUT 30)
if(NOT code STREQUAL CODE OR NOT output MATCHES "${TEXT}")
    message(FATAL_ERROR "exit code ${code}, expected ${CODE}; or no '${TEXT}' in:\n${output}")
endif()
