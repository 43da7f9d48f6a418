// Starts OpenOCD, waits for its end and keeps its output.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "host/io/folder/open_folder.hpp"

namespace octoskin::flashing {

struct OpenocdRun {
    enum class End {
        not_found,   ///< no `openocd` on the PATH
        no_process,  ///< it exists but cannot be started; the reason is in `output`
        timed_out,   ///< killed after its time
        exited,
    };
    End end = End::not_found;
    int exit_code = 0;   ///< if `exited`; 128 + the signal's number if a signal ended it
    std::string output;  ///< standard output and standard error; the first MiB
};

/// The path of run_openocd()'s `folder` for OpenOCD: by its descriptor, so that renaming the folder has no
/// effect.
inline constexpr const char* kOpenocdFolder = "/proc/self/fd/3";

/// Runs `openocd ARGUMENTS...` with `folder` as kOpenocdFolder. Blocks until it ends, at most `patience`.
/// The working directory is /: OpenOCD looks for sourced scripts beneath its working directory first and runs
/// what it finds. That must not be a folder into which other users may write.
[[nodiscard]] OpenocdRun run_openocd(const OpenFolder& folder, std::vector<std::string> arguments,
                                     std::chrono::seconds patience);

}  // namespace octoskin::flashing
