// Sockets of the local machine by the name of a file.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// A socket bound to `file`; non-blocking. `type`: SOCK_DGRAM or SOCK_STREAM (then it listens). A file that a
/// dead process left is replaced; one that somebody listens on is refused, also if both begin at once; the
/// error names the process of a SOCK_STREAM that lets us in. Waits 2 s at most for another that makes a
/// socket in that folder. Who may connect: owner and group. `option`: of the command line, that names another
/// place.
[[nodiscard]] Result<int, AppError> bind_unix_socket(const std::filesystem::path& file, int type,
                                                     const std::string& option = "--socket");

/// A socket connected to `file`. Waits `patience` at most for whoever listens there and lets nobody in, as a
/// process that is stopped: ExitCode::io_failed then.
[[nodiscard]] Result<int, AppError> connect_unix_socket(
    const std::filesystem::path& file, int type,
    std::chrono::milliseconds patience = std::chrono::seconds{5});

}  // namespace octoskin
