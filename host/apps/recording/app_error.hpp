// Errors of `octoskin` as exit codes for the shell and messages for people.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "common/result.hpp"

namespace octoskin {

/// After sysexits.h, so that a script or a service manager can distinguish causes.
enum class ExitCode : int {
    ok = 0,
    failed = 1,          ///< the work was done, and its result is bad
    uncertain = 2,       ///< the work was done, and its result is uncertain
    usage = 64,          ///< the command line
    bad_data = 65,       ///< a recording, map or world that cannot be used
    no_input = 66,       ///< an input file that does not exist
    unavailable = 69,    ///< a program or a device that does not exist
    no_resources = 71,   ///< too little memory, descriptors or threads, in the system or by a limit of this
                         ///< process (ulimit)
    cannot_create = 73,  ///< an output file
    io_failed = 74,      ///< a device that existed, or standard output, failed during the work
    no_permission = 77,  ///< to use a device, or to read a file
    bad_config = 78,     ///< rig, robot, mapping or scenario file
};

struct AppError {
    ExitCode code = ExitCode::failed;
    std::string message;  ///< what failed, file, value, remedy
};

[[nodiscard]] inline Unexpected<AppError> fail(ExitCode code, std::string message) {
    return unexpected(AppError{code, std::move(message)});
}
/// The error for an output file or folder.
[[nodiscard]] inline Unexpected<AppError> cannot_create(const std::filesystem::path& output,
                                                        const std::string& what) {
    return fail(ExitCode::cannot_create, output.string() + ": " + what);
}

}  // namespace octoskin
