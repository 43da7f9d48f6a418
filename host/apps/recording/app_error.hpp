// Errors of `octoskin` as exit codes for the shell and messages for people.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

/// After sysexits.h, so that a script or a service manager can distinguish causes.
enum class ExitCode : int {
    ok = 0,
    failed = 1,          ///< the work was done, and its result is bad
    uncertain = 2,       ///< the work was done, and its result is uncertain
    usage = 64,          ///< a wrong command line
    bad_data = 65,       ///< a recording, map or world that cannot be used
    no_input = 66,       ///< an input file that does not exist
    unavailable = 69,    ///< a daemon, program or device that cannot be used now
    no_resources = 71,   ///< too little memory, descriptors or threads, in the system or by a limit of this
                         ///< process (ulimit)
    cannot_create = 73,  ///< an output that cannot be created
    io_failed = 74,      ///< a device that existed, or standard output, failed during the work
    no_permission = 77,  ///< none to use a device, or to read a file
    bad_config = 78,     ///< a wrong rig, robot, mapping or scenario file
};

/// An error with the exit code of the command that it ends.
struct AppError {
    ExitCode exit = ExitCode::failed;
    Error error = {};

    [[nodiscard]] std::string message() const { return error.message(); }
};

[[nodiscard]] inline Unexpected<AppError> fail(ExitCode exit, Error error) {
    return unexpected(AppError{exit, std::move(error)});
}
/// The same error with a further remedy: "REMEDY, or OTHER".
[[nodiscard]] inline Error with_remedy(Error error, const std::string& other) {
    error.remedy.append(error.remedy.empty() ? "" : ", or ").append(other);
    return error;
}
/// The error for an output file or folder.
[[nodiscard]] inline Unexpected<AppError> cannot_create(const std::filesystem::path& output, Error error) {
    return fail(ExitCode::cannot_create, in_file(std::move(error), output));
}

}  // namespace octoskin
