// Starts OpenOCD, waits for its end, keeps what it said.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "host/io/folder/open_folder.hpp"

namespace octoskin::flashing {

struct OpenocdRun {
    enum class End {
        not_found,   ///< no `openocd` on the PATH
        no_process,  ///< it is there and cannot be started; `output` says why
        timed_out,   ///< killed
        exited,
    };
    End end = End::not_found;
    int exit_code = 0;   ///< of `exited`; 128 + the signal if one ended it
    std::string output;  ///< standard output and standard error; the first MiB
};

/// `folder` of run_openocd(), as OpenOCD finds it: by its descriptor, whatever becomes of its name.
inline constexpr const char* kOpenocdFolder = "/proc/self/fd/3";

/// `openocd ARGUMENTS...` with `folder` as kOpenocdFolder. Blocks until it ends, at most `patience`. It runs
/// in /: OpenOCD looks for each script that another one sources beneath its working directory first, and runs
/// what it finds there, so that must be no folder that others may have filled.
[[nodiscard]] OpenocdRun run_openocd(const OpenFolder& folder, std::vector<std::string> arguments,
                                     std::chrono::seconds patience);

}  // namespace octoskin::flashing
