# The targets format, format-check and tidy for the files that git tracks.
find_program(OCTOSKIN_CLANG_FORMAT clang-format)
find_program(OCTOSKIN_RUN_CLANG_TIDY NAMES run-clang-tidy run-clang-tidy-14)
if(OCTOSKIN_CLANG_FORMAT)
    # In groups of files: the time of one process grows with the square of their number, to 55 s for all.
    set(OCTOSKIN_FORMAT_SOURCES "git ls-files '*.cpp' '*.hpp' | xargs -P 4 -n 50 ${OCTOSKIN_CLANG_FORMAT}")
    add_custom_target(format COMMAND sh -c "${OCTOSKIN_FORMAT_SOURCES} -i"
        WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
    add_custom_target(format-check COMMAND sh -c "${OCTOSKIN_FORMAT_SOURCES} --dry-run --Werror"
        WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
endif()
if(OCTOSKIN_RUN_CLANG_TIDY)
    # Tests are left out: GoogleTest's macros trip most checks. The path filter is a regular expression. Only in the debug
    # build, which compiles every file by itself: a file that is compiled within another would be left out without a
    # message.
    if(CMAKE_BUILD_TYPE STREQUAL "Debug")
        add_custom_target(tidy COMMAND ${OCTOSKIN_RUN_CLANG_TIDY} -quiet -p ${PROJECT_BINARY_DIR}
            "${PROJECT_SOURCE_DIR}/(common|firmware|host|hw)/.*\\.cpp$" WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
    endif()
    # For code that runs on a board, in every check; without the analyzer, which takes as long as all other checks
    # together. Sources that are compiled several at once are checked several at once, in a fifth of the time: CMake
    # generates the file that includes them, so they count as its headers.
    add_custom_target(tidy-firmware COMMAND ${OCTOSKIN_RUN_CLANG_TIDY} -quiet -p ${PROJECT_BINARY_DIR}
        -checks=-clang-analyzer-*,-bugprone-suspicious-include "-header-filter=/(common|firmware)/.*\\.[ch]pp$"
        "${PROJECT_SOURCE_DIR}/(common|firmware)/.*\\.cpp$" "${PROJECT_BINARY_DIR}/(common|firmware)/.*/Unity/.*\\.cxx$"
        WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
endif()
