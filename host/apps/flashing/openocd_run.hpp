// Starts OpenOCD, waits for its end, keeps what it said.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

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

/// `openocd ARGUMENTS...` in `folder`. Blocks until it ends, at most `patience`.
[[nodiscard]] OpenocdRun run_openocd(const std::filesystem::path& folder, std::vector<std::string> arguments,
                                     std::chrono::seconds patience);

}  // namespace octoskin::flashing
