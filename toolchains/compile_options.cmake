# One interface target carries warnings, sanitizers and coverage; every target of ours links it privately.
add_library(octoskin_compile_options INTERFACE)
target_compile_options(octoskin_compile_options INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wdouble-promotion -Wundef -Wswitch-enum -Werror
    # Equal inputs give equal map bytes, and ray stepping equals OctoMap's, only without fused multiply-add.
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
    # The address sanitizer stops at a null pointer that is followed and at a place beyond an object, too, and a PC reads
    # what is not aligned: asked again at every access this takes a quarter of the compiler's time. A board faults on it.
    set(runs_on_a_board $<IN_LIST:$<TARGET_PROPERTY:OCTOSKIN_ROOM>,common$<SEMICOLON>firmware/drivers$<SEMICOLON>firmware/core$<SEMICOLON>firmware/port>)
    target_compile_options(octoskin_compile_options INTERFACE
        $<$<NOT:${runs_on_a_board}>:-fno-sanitize=null,alignment,object-size>)
endif()
# Code that runs once or works on nothing large: programs, tests, commands, texts, JSON. Where much of a build's time goes, and little
# of a program's. Under sanitizers it is not optimised, which takes half the compiler's time. octoskin_program_options is for
# programs, octoskin_test_options for tests, octoskin_app_options for the libraries of OCTOSKIN_APP_ROOMS: after the above.
add_library(octoskin_program_options INTERFACE)
add_library(octoskin_test_options INTERFACE)
add_library(octoskin_app_options INTERFACE)
if(OCTOSKIN_SANITIZE)
    target_compile_options(octoskin_program_options INTERFACE -O0)
    target_link_libraries(octoskin_test_options INTERFACE octoskin_program_options)
    target_link_libraries(octoskin_app_options INTERFACE octoskin_program_options)
elseif(CMAKE_BUILD_TYPE STREQUAL "Release")
    # When it optimises little, GCC 12 warns in vain of optional values, and of `std::string(...) + "..."` as if the longer
    # string lay in the short one's own bytes. The address sanitizer sees what does overflow.
    target_compile_options(octoskin_app_options INTERFACE -O1
        $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized$<SEMICOLON>-Wno-array-bounds$<SEMICOLON>-Wno-stringop-overflow$<SEMICOLON>-Wno-stringop-overread>)
    target_link_libraries(octoskin_test_options INTERFACE octoskin_app_options)
endif()
if(OCTOSKIN_COVERAGE)
    target_compile_options(octoskin_compile_options INTERFACE --coverage -fprofile-update=atomic)
    target_link_options(octoskin_compile_options INTERFACE --coverage)
endif()
if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
    # Simulation and tests, which no board runs outside an emulator, may throw.
    set(may_throw $<IN_LIST:$<TARGET_PROPERTY:OCTOSKIN_ROOM>,hw/sim$<SEMICOLON>tests>)
    target_compile_options(octoskin_compile_options INTERFACE
        $<$<NOT:${may_throw}>:-fno-exceptions> -fno-rtti -fno-threadsafe-statics
        -ffunction-sections -fdata-sections -fstack-usage
        # Says only that arguments are passed otherwise than before GCC 7.1; everything here is one compiler's work.
        -Wno-psabi)
endif()
