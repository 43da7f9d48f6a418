# The rooms (top-level parts) of the project, and which may depend on which. A target that breaks a rule fails to
# configure.
#
#   octoskin_library(<name> ROOM <room> [FOLDER <folder>] SOURCES a.cpp ... HEADERS a.hpp ... [DEPENDS octoskin::x ...]
#                    [PRIVATE_DEPENDS octoskin::y ...] [EXTERNAL lib ...] [PRIVATE_EXTERNAL lib ...] [APART]
#                    [IN_MODULE] [LONG_LOOPS])
#   octoskin_program(<name> ROOM <room> [FOLDER <folder>] SOURCES ... [DEPENDS ...] [EXTERNAL ...])
#   octoskin_test(<name> [FOLDER <folder>] LABELS unit SOURCES ... [HOST_SOURCES ...] DEPENDS ... [EXTERNAL ...] [APART ...] [HALF_IN_QEMU <filter>]
#                 [ALONE | WAITS] [COST <seconds>] [RELEASE_TOO] [THREADED <source>...])
#
# In the rooms of OCTOSKIN_UNITY, several sources of a library or a test program are compiled at once. Exceptions are a
# library with APART, and the sources that a test program lists as APART: a file-local name in them also occurs in another
# file.
#
# SOURCES, HEADERS and the like are below FOLDER, which is below the folder of the CMakeLists.txt: each room has one, and
# so has the folder of tests for it.
#
# DEPENDS lists the project's targets only; EXTERNAL lists third-party ones. Includes are written from the repository's
# root ("common/wire/codec.hpp"), so every include line contains the room that it uses.
#
# In the rooms of OCTOSKIN_APP_ROOMS a library is optimised little, unless it has LONG_LOOPS: code that processes voxels
# is in other rooms.
#
# IN_MODULE: a library that is linked into a module loaded at run time.
#
# Built for a board (preset target-tests), a test program or a library of tests is left out if it depends on a library
# that is not built for one. Of the others the HOST_SOURCES are left out, which need an operating system, or minutes
# there. Each is named when configuring. A program that mostly WAITS counts as half a processor: twice as many run at once
# as there are processors. HALF_IN_QEMU, a filter of GoogleTest, splits a program there into two tests: the selected cases
# and the rest.
#
# The test with the highest COST starts first: if a test of half a minute started last, all processors but one would wait
# for it.
#
# Builds of ./check: a test of label unit runs under the address sanitizer only (label `sanitized`), unless it has
# RELEASE_TOO, because under a sanitizer it does less or measures something else. A test of another label runs in the
# release build (target octoskin_release_tests); those that the preset host-asan-ubsan lists run there, too. THREADED are
# the sources that use threads: under the thread sanitizer a test consists of these only (octoskin_thread_tests).

set(OCTOSKIN_MAY_USE_common common)
set(OCTOSKIN_MAY_USE_firmware/drivers common firmware/drivers)
set(OCTOSKIN_MAY_USE_firmware/core common firmware/drivers firmware/core)
set(OCTOSKIN_MAY_USE_firmware/port common firmware/drivers firmware/core firmware/port)
set(OCTOSKIN_MAY_USE_hw/dbc common hw/dbc)
set(OCTOSKIN_MAY_USE_host/errors host/errors)
set(OCTOSKIN_MAY_USE_host/io/folder common host/errors host/io/folder)
set(OCTOSKIN_MAY_USE_hw/rigfile common host/errors host/io/folder hw/rigfile)
set(OCTOSKIN_MAY_USE_hw/mesh common hw/mesh hw/rigfile)
set(OCTOSKIN_MAY_USE_hw/image common host/errors hw/image hw/rigfile)
set(OCTOSKIN_MAY_USE_hw/sim common firmware/drivers firmware/core host/errors host/io/folder hw/image hw/mesh hw/rigfile hw/sim)
set(OCTOSKIN_MAY_USE_host/core common host/core host/errors)
set(OCTOSKIN_MAY_USE_host/io common host/core host/errors hw/mesh hw/rigfile host/io host/io/folder)
# The product: it does not depend on the simulator or the laboratory.
set(OCTOSKIN_MAY_USE_host/apps common firmware/drivers firmware/core hw/image hw/rigfile host/core host/errors host/io host/io/folder
    host/apps)
# A program of its own, a client of the daemon.
set(OCTOSKIN_MAY_USE_host/bridge common hw/rigfile host/core host/errors host/io host/io/folder host/apps host/bridge)
set(OCTOSKIN_ALL_ROOMS common firmware/drivers firmware/core firmware/port hw/dbc hw/image hw/mesh hw/rigfile hw/sim host/core
    host/errors host/io host/io/folder host/apps host/bridge host/lab firmware/app tests)
set(OCTOSKIN_MAY_USE_host/lab ${OCTOSKIN_ALL_ROOMS})
set(OCTOSKIN_MAY_USE_firmware/app ${OCTOSKIN_ALL_ROOMS})
set(OCTOSKIN_MAY_USE_tests ${OCTOSKIN_ALL_ROOMS})

set(OCTOSKIN_APP_ROOMS "host/(apps|bridge|lab)")
if(OCTOSKIN_SANITIZE)  # the rooms that read and write files, too
    set(OCTOSKIN_APP_ROOMS "host/(apps|bridge|io|io/folder|lab)|hw/(dbc|image|rigfile)|firmware/app")
endif()

function(octoskin_check_room target room)
    if(NOT DEFINED OCTOSKIN_MAY_USE_${room})
        message(FATAL_ERROR "${target}: unknown room '${room}'; the rooms are ${OCTOSKIN_ALL_ROOMS}")
    endif()
    foreach(dependency IN LISTS ARGN)
        if(NOT TARGET ${dependency})
            message(FATAL_ERROR "${target}: no target '${dependency}' (add its folder before this one)")
        endif()
        get_target_property(dependency_room ${dependency} OCTOSKIN_ROOM)
        if(NOT dependency_room)
            message(FATAL_ERROR "${target}: '${dependency}' is in no room; third-party targets go to EXTERNAL")
        endif()
        if(NOT dependency_room IN_LIST OCTOSKIN_MAY_USE_${room})
            message(FATAL_ERROR "${target}: room '${room}' must not depend on '${dependency}' of room "
                "'${dependency_room}'; it may use: ${OCTOSKIN_MAY_USE_${room}}")
        endif()
    endforeach()
endfunction()

# Refuses an include line of a forbidden room, too, so that a dependency on a header alone is detected.
function(octoskin_check_includes target room)
    foreach(file IN LISTS ARGN)
        file(STRINGS ${file} lines REGEX "^#include \"(common|firmware|hw|host|tests)/")
        foreach(line IN LISTS lines)
            set(is_allowed FALSE)
            foreach(allowed IN LISTS OCTOSKIN_MAY_USE_${room})
                if(line MATCHES "^#include \"${allowed}/")
                    set(is_allowed TRUE)
                endif()
            endforeach()
            if(NOT is_allowed)
                message(FATAL_ERROR "${target}: ${file} of room '${room}' must not contain: ${line}")
            endif()
        endforeach()
    endforeach()
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
endfunction()

# The headers that no source proves to compile alone. A source of the same name proves it: its first include is its
# header.
function(octoskin_headers_to_verify result sources)
    set(unproven "")
    foreach(header IN LISTS ARGN)
        string(REGEX REPLACE "[.]hpp$" ".cpp" source ${header})
        set(first_line "")
        if(source IN_LIST sources)
            file(STRINGS ${source} first_line LIMIT_COUNT 1 REGEX "^[ \t]*#")
        endif()
        cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE path)
        if(NOT first_line STREQUAL "#include \"${path}\"")
            list(APPEND unproven ${header})
        endif()
    endforeach()
    set(${result} "${unproven}" PARENT_SCOPE)
endfunction()

# TRUE, with a message, if this is a build for a board and a dependency is not built for it.
function(octoskin_is_left_out result target)
    set(${result} FALSE PARENT_SCOPE)
    if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
        foreach(dependency IN LISTS ARGN)
            if(NOT TARGET ${dependency})
                message(STATUS "Not on the target: ${target}, which needs ${dependency}")
                set(${result} TRUE PARENT_SCOPE)
                return()
            endif()
        endforeach()
    endif()
endfunction()

# The folder of a target's sources, from its argument FOLDER.
macro(octoskin_set_folder)
    set(folder ${CMAKE_CURRENT_SOURCE_DIR})
    if(ARG_FOLDER)
        string(APPEND folder /${ARG_FOLDER})
    endif()
endmacro()

# Rooms of applications: commands, messages and output, which process little data.
function(octoskin_compile_as_app target)
    target_link_libraries(${target} PRIVATE octoskin_app_options)
    if(TARGET octoskin_app_headers)
        # With the definitions of the precompiled headers.
        target_link_libraries(${target} PRIVATE fmt::fmt nlohmann_json::nlohmann_json spdlog::spdlog)
        target_precompile_headers(${target} REUSE_FROM octoskin_app_headers)
    endif()
endfunction()

function(octoskin_library name)
    cmake_parse_arguments(ARG "APART;IN_MODULE;LONG_LOOPS" "ROOM;FOLDER" "SOURCES;HEADERS;DEPENDS;PRIVATE_DEPENDS;EXTERNAL;PRIVATE_EXTERNAL" ${ARGN})
    if(ARG_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "octoskin_library(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
    endif()
    if(ARG_ROOM STREQUAL "tests")
        octoskin_is_left_out(is_left_out octoskin::${name}
            ${ARG_DEPENDS} ${ARG_PRIVATE_DEPENDS} ${ARG_EXTERNAL} ${ARG_PRIVATE_EXTERNAL})
        if(is_left_out)
            return()
        endif()
    endif()
    octoskin_check_room(octoskin::${name} ${ARG_ROOM} ${ARG_DEPENDS} ${ARG_PRIVATE_DEPENDS})
    octoskin_set_folder()
    list(TRANSFORM ARG_HEADERS PREPEND ${folder}/ OUTPUT_VARIABLE headers)
    list(TRANSFORM ARG_SOURCES PREPEND ${folder}/ OUTPUT_VARIABLE sources)
    octoskin_check_includes(octoskin::${name} ${ARG_ROOM} ${headers} ${sources})
    set(target octoskin_${name})
    if(ARG_SOURCES)
        add_library(${target} STATIC)
        target_sources(${target} PRIVATE ${sources})
        if(OCTOSKIN_UNITY AND ARG_ROOM MATCHES "^(${OCTOSKIN_UNITY})$" AND NOT ARG_APART)
            set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
            # In a unity build, a class with members of an unnamed namespace is not in the compiler's main file.
            target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
        endif()
        if(ARG_IN_MODULE)
            set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
        elseif(ARG_ROOM MATCHES "^(${OCTOSKIN_APP_ROOMS})$" AND NOT ARG_LONG_LOOPS)
            octoskin_compile_as_app(${target})
        elseif(TARGET octoskin_host_headers AND ARG_ROOM MATCHES "^(host|hw)/")
            target_precompile_headers(${target} REUSE_FROM octoskin_host_headers)
        endif()
        set(scope PUBLIC)
        target_link_libraries(${target} PRIVATE octoskin_compile_options ${ARG_PRIVATE_DEPENDS} ${ARG_PRIVATE_EXTERNAL})
    else()
        add_library(${target} INTERFACE)
        set(scope INTERFACE)
    endif()
    octoskin_headers_to_verify(to_verify "${sources}" ${headers})
    list(REMOVE_ITEM headers ${to_verify})
    target_sources(${target} ${scope}
        FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers}
        FILE_SET to_verify TYPE HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${to_verify})
    target_compile_features(${target} ${scope} cxx_std_20)
    target_link_libraries(${target} ${scope} ${ARG_DEPENDS} ${ARG_EXTERNAL})
    set_target_properties(${target} PROPERTIES OCTOSKIN_ROOM ${ARG_ROOM}
        VERIFY_INTERFACE_HEADER_SETS ON INTERFACE_HEADER_SETS_TO_VERIFY to_verify)
    add_library(octoskin::${name} ALIAS ${target})
endfunction()

function(octoskin_program name)
    cmake_parse_arguments(ARG "" "ROOM;FOLDER" "SOURCES;DEPENDS;EXTERNAL" ${ARGN})
    octoskin_check_room(${name} ${ARG_ROOM} ${ARG_DEPENDS})
    octoskin_set_folder()
    list(TRANSFORM ARG_SOURCES PREPEND ${folder}/ OUTPUT_VARIABLE sources)
    octoskin_check_includes(${name} ${ARG_ROOM} ${sources})
    add_executable(${name} ${sources})
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
    target_compile_features(${name} PRIVATE cxx_std_20)
    target_link_libraries(${name} PRIVATE octoskin_compile_options octoskin_program_options ${ARG_DEPENDS} ${ARG_EXTERNAL})
    # No search path of libraries, except for a program that sets its own. The path is the same in the build and when
    # installed: CMake pads the shorter one with empty folders, each of which means the working directory.
    set_target_properties(${name} PROPERTIES OCTOSKIN_ROOM ${ARG_ROOM} RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin
        INSTALL_RPATH "" BUILD_WITH_INSTALL_RPATH ON)
endfunction()

# The helper programs that other programs start from their own folder.
set(OCTOSKIN_HELPERS octoskin-camera octoskin-film octoskin-mesh-read octoskin-oni-read octoskin-oni-write)
set(OCTOSKIN_LAB_HELPERS octoskin-world-read)

# Lets tests that are built in this folder find them, too.
function(octoskin_helpers_beside_tests)
    foreach(helper IN LISTS OCTOSKIN_HELPERS OCTOSKIN_LAB_HELPERS)
        file(CREATE_LINK ${PROJECT_BINARY_DIR}/bin/${helper} ${CMAKE_CURRENT_BINARY_DIR}/${helper} SYMBOLIC)
    endforeach()
endfunction()

# Each build links about a hundred tests; LLVM's linker takes a fifth to a half of the time of the default one.
find_program(OCTOSKIN_TEST_LINKER ld.lld)

function(octoskin_test name)
    cmake_parse_arguments(ARG "ALONE;WAITS;RELEASE_TOO" "COST;TIMEOUT;HALF_IN_QEMU;FOLDER"
        "LABELS;SOURCES;HOST_SOURCES;THREADED;DEPENDS;EXTERNAL;APART" ${ARGN})
    if(NOT ARG_TIMEOUT)
        set(ARG_TIMEOUT 60)
    endif()
    octoskin_is_left_out(is_left_out ${name} ${ARG_DEPENDS} ${ARG_EXTERNAL})
    if(is_left_out)
        return()
    endif()
    if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
        foreach(source IN LISTS ARG_HOST_SOURCES)
            message(STATUS "Not on the target: ${source} of ${name}, which needs an operating system or minutes")
        endforeach()
    else()
        list(APPEND ARG_SOURCES ${ARG_HOST_SOURCES})
    endif()
    if(OCTOSKIN_SANITIZE OR CMAKE_SYSTEM_NAME STREQUAL "Generic")  # or in an emulator
        math(EXPR ARG_TIMEOUT "5 * ${ARG_TIMEOUT}")
    elseif(CMAKE_CROSSCOMPILING)  # in an emulator, which other work slows down
        math(EXPR ARG_TIMEOUT "20 * ${ARG_TIMEOUT}")
    endif()
    if(ARG_THREADED AND OCTOSKIN_SANITIZE MATCHES "thread")
        set(ARG_SOURCES ${ARG_THREADED})
    endif()
    octoskin_check_room(${name} tests ${ARG_DEPENDS})
    octoskin_helpers_beside_tests()
    octoskin_set_folder()
    list(TRANSFORM ARG_SOURCES PREPEND ${folder}/)
    list(TRANSFORM ARG_APART PREPEND ${folder}/)
    add_executable(${name} ${ARG_SOURCES})
    if(OCTOSKIN_TEST_LINKER AND NOT CMAKE_CROSSCOMPILING)
        target_link_options(${name} PRIVATE -fuse-ld=lld)
    endif()
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
    target_compile_features(${name} PRIVATE cxx_std_20)
    target_compile_definitions(${name} PRIVATE OCTOSKIN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    target_link_libraries(${name} PRIVATE octoskin_compile_options ${ARG_DEPENDS} ${ARG_EXTERNAL}
        GTest::gmock GTest::gtest_main)
    if(OCTOSKIN_UNITY AND "tests" MATCHES "^(${OCTOSKIN_UNITY})$")
        set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
        set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
    # Not for long simulations: the linker uses the test's less optimised copy of an inline function, which costs more
    # time than their few files save.
    if(NOT "sim" IN_LIST ARG_LABELS)
        target_link_libraries(${name} PRIVATE octoskin_test_options)
        if(TARGET octoskin_test_headers)
            target_precompile_headers(${name} REUSE_FROM octoskin_test_headers)
        endif()
    elseif(TARGET octoskin_sim_test_headers)
        target_precompile_headers(${name} REUSE_FROM octoskin_sim_test_headers)
    endif()
    set_target_properties(${name} PROPERTIES OCTOSKIN_ROOM tests BUILD_RPATH ${PROJECT_BINARY_DIR}/bin)
    set(cost "")
    if(ARG_COST)
        set(cost COST ${ARG_COST})
    endif()
    set(halves 2)
    if(ARG_WAITS AND NOT OCTOSKIN_SANITIZE)  # a sanitizer needs processor time
        set(halves 1)
    endif()
    if("unit" IN_LIST ARG_LABELS)
        add_dependencies(octoskin_unit_tests ${name})
    endif()
    if("unit" IN_LIST ARG_LABELS AND NOT ARG_RELEASE_TOO)
        list(APPEND ARG_LABELS sanitized)
    else()
        add_dependencies(octoskin_release_tests ${name})
    endif()
    if(ARG_THREADED)
        list(APPEND ARG_LABELS threads)
        add_dependencies(octoskin_thread_tests ${name})
    endif()
    if("unit" IN_LIST ARG_LABELS OR "property" IN_LIST ARG_LABELS)
        # One process for the whole file: the unit suite must stay under ten seconds.
        set(tests ${name})
        if(ARG_HALF_IN_QEMU AND CMAKE_SYSTEM_NAME STREQUAL "Generic")
            list(APPEND tests ${name}.other_half)
            add_test(NAME ${name} COMMAND ${name} -append "--gtest_filter=${ARG_HALF_IN_QEMU}")
            add_test(NAME ${name}.other_half COMMAND ${name} -append "--gtest_filter=-${ARG_HALF_IN_QEMU}")
        else()
            add_test(NAME ${name} COMMAND ${name})
        endif()
        set_tests_properties(${tests} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} PROCESSORS ${halves} ${cost})
        if(CMAKE_CROSSCOMPILING AND NOT CMAKE_SYSTEM_NAME STREQUAL "Generic")
            set_tests_properties(${name} PROPERTIES ENVIRONMENT "GTEST_FILTER=-${OCTOSKIN_NOT_IN_QEMU_USER}")
        endif()
    else()
        gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
            PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} PROCESSORS ${halves} RUN_SERIAL ${ARG_ALONE} ${cost})
    endif()
endfunction()
