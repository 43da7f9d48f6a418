# One interface target carries warnings, sanitizers and coverage; every target of the project links it privately.
add_library(octoskin_compile_options INTERFACE)
target_compile_options(octoskin_compile_options INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wdouble-promotion -Wundef -Wswitch-enum -Werror
    # Without fused multiply-add, equal inputs give equal map bytes and ray stepping equals OctoMap's.
    -ffp-contract=off)

# Asserts stay on in every build: a programmer's mistake must stop the program where it was made.
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_MINSIZEREL "${CMAKE_CXX_FLAGS_MINSIZEREL}")

set(OCTOSKIN_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize= takes them")
option(OCTOSKIN_LIBFUZZER "Link the fuzz targets with clang's libFuzzer; needs fuzzer-no-link among the sanitizers" OFF)
set(OCTOSKIN_UNITY "" CACHE STRING
    "Rooms (a regular expression) whose libraries' sources are compiled several at once: a whole build takes less, a small change more")
option(OCTOSKIN_COVERAGE "Instrument for gcov" OFF)
if(OCTOSKIN_SANITIZE)
    target_compile_options(octoskin_compile_options INTERFACE
        -fsanitize=${OCTOSKIN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(octoskin_compile_options INTERFACE -fsanitize=${OCTOSKIN_SANITIZE})
    target_compile_definitions(octoskin_compile_options INTERFACE OCTOSKIN_SANITIZED)
endif()
if(OCTOSKIN_SANITIZE MATCHES "address")
    # Off except for code that runs on a board, which faults on such accesses. The address sanitizer also detects null
    # pointers and accesses beyond an object, and a PC reads unaligned data. At every access these checks take a quarter
    # of the compile time.
    set(runs_on_a_board $<IN_LIST:$<TARGET_PROPERTY:OCTOSKIN_ROOM>,common$<SEMICOLON>firmware/drivers$<SEMICOLON>firmware/core$<SEMICOLON>firmware/port>)
    target_compile_options(octoskin_compile_options INTERFACE
        $<$<NOT:${runs_on_a_board}>:-fno-sanitize=null,alignment,object-size>)
endif()
# Options for code that runs once or processes little data: programs, tests, commands, texts, JSON. It takes much of the
# build time and little of the run time. Under sanitizers it is not optimised, which halves the compile time.
# octoskin_program_options is for programs, octoskin_test_options for tests, octoskin_app_options for the libraries of
# OCTOSKIN_APP_ROOMS; link them after the options above.
add_library(octoskin_program_options INTERFACE)
add_library(octoskin_test_options INTERFACE)
add_library(octoskin_app_options INTERFACE)
if(OCTOSKIN_SANITIZE)
    target_compile_options(octoskin_program_options INTERFACE -O0)
    target_link_libraries(octoskin_test_options INTERFACE octoskin_program_options)
    target_link_libraries(octoskin_app_options INTERFACE octoskin_program_options)
elseif(CMAKE_BUILD_TYPE STREQUAL "Release")
    # At low optimisation GCC 12 has false warnings about optional values and about `std::string(...) + "..."`, as if the
    # longer string overflowed the short one's internal buffer. The address sanitizer detects real overflows.
    target_compile_options(octoskin_app_options INTERFACE -O1
        $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized$<SEMICOLON>-Wno-array-bounds$<SEMICOLON>-Wno-stringop-overflow$<SEMICOLON>-Wno-stringop-overread>)
    target_link_libraries(octoskin_test_options INTERFACE octoskin_app_options)
endif()
if(OCTOSKIN_COVERAGE)
    target_compile_options(octoskin_compile_options INTERFACE --coverage -fprofile-update=atomic)
    target_link_options(octoskin_compile_options INTERFACE --coverage)
endif()
if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
    # Simulation and tests may throw: a board runs them only in an emulator.
    set(may_throw $<IN_LIST:$<TARGET_PROPERTY:OCTOSKIN_ROOM>,hw/sim$<SEMICOLON>tests>)
    target_compile_options(octoskin_compile_options INTERFACE
        $<$<NOT:${may_throw}>:-fno-exceptions> -fno-rtti -fno-threadsafe-statics
        -ffunction-sections -fdata-sections -fstack-usage
        # Only a note that arguments are passed differently from before GCC 7.1; one compiler builds everything here.
        -Wno-psabi)
endif()
