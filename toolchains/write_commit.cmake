# Writes the commit that is being built into a C++ file, at build time: cmake -DSOURCE_DIR=.. -DOUT=commit.cpp -P this.
# The file is written only if its content changes, so that nothing else is rebuilt. Without git, or in a tree that is not
# a clone (a tarball), the commit is "unknown".
execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse --show-toplevel
    OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
file(REAL_PATH ${SOURCE_DIR} source_dir)
set(commit unknown)
set(is_changed false)
if(NOT failed AND top STREQUAL source_dir)
    execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse --short=12 HEAD
        OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    execute_process(COMMAND git -C ${SOURCE_DIR} --no-optional-locks status --porcelain --untracked-files=no
        OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT failed)
        set(commit ${head})
        if(changes)
            set(is_changed true)
        endif()
    endif()
endif()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[// Written by toolchains/write_commit.cmake at build time.
#include "host/apps/version/version.hpp"

const char* const octoskin::kCommit = "@commit@";
const bool octoskin::kIsCommitChanged = @is_changed@;
]])
