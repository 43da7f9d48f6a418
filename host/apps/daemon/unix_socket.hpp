// Unix sockets with a file name.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// Returns a non-blocking socket bound to `file`. `type`: SOCK_DGRAM, or SOCK_STREAM (then it listens). A
/// file that a dead process left is replaced. One with a listener is refused, also if both start at once; the
/// error names the process of a SOCK_STREAM that accepts the connection. Waits at most 2 s for another
/// process that creates a socket in that folder. Owner and group may connect. `option`: the command-line
/// option that names another place.
[[nodiscard]] Result<int, AppError> bind_unix_socket(const std::filesystem::path& file, int type,
                                                     const std::string& option = "--socket");

/// Returns a socket connected to `file`. Waits at most `patience` for a listener that accepts no connection,
/// such as a stopped process: then ExitCode::io_failed.
[[nodiscard]] Result<int, AppError> connect_unix_socket(
    const std::filesystem::path& file, int type,
    std::chrono::milliseconds patience = std::chrono::seconds{5});

}  // namespace octoskin
