// What `octoskin` tells the shell and the person when something cannot be done.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "common/result.hpp"

namespace octoskin {

/// After sysexits.h, so that a script or a service manager can tell what went wrong.
enum class ExitCode : int {
    ok = 0,
    failed = 1,        ///< the work was done and its result is bad
    uncertain = 2,     ///< the work was done, and its result is that nobody knows
    usage = 64,        ///< the command line
    bad_data = 65,     ///< a recording, map or world that cannot be used
    no_input = 66,     ///< a file that is not there
    unavailable = 69,  ///< a program or a device that is not there
    no_resources =
        71,  ///< the system or a limit of this process (ulimit) has too little memory, descriptors, threads
    cannot_create = 73,  ///< an output file
    io_failed = 74,      ///< a device that was there, or the standard output, failed in its work
    no_permission = 77,  ///< to use a device, or to read a file
    bad_config = 78,     ///< rig, robot, mapping or scenario file
};

struct AppError {
    ExitCode code = ExitCode::failed;
    std::string message;  ///< what, where, the value, what to do
};

[[nodiscard]] inline Unexpected<AppError> fail(ExitCode code, std::string message) {
    return unexpected(AppError{code, std::move(message)});
}
/// An output file or folder, and what is wrong with it.
[[nodiscard]] inline Unexpected<AppError> cannot_create(const std::filesystem::path& output,
                                                        const std::string& what) {
    return fail(ExitCode::cannot_create, output.string() + ": " + what);
}

}  // namespace octoskin
