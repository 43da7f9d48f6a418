// Unix sockets with a file name.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// The file of a bound socket.
class SocketFile {
  public:
    /// What is at `path` now.
    explicit SocketFile(std::filesystem::path path);
    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
    /// Removes it, unless its name is another file's by now: of another process, or of the user. Call it
    /// while the socket is open, so that no other file gets its inode.
    void remove() const;

  private:
    struct Identity {
        dev_t device = 0;
        ino_t inode = 0;
        friend bool operator==(const Identity&, const Identity&) = default;
    };
    [[nodiscard]] std::optional<Identity> found() const;

    std::filesystem::path path_;
    std::optional<Identity> bound_;
};

struct BoundSocket {
    int descriptor;
    SocketFile file;
};

/// Returns a non-blocking socket bound to `file`. `type`: SOCK_DGRAM, or SOCK_STREAM (then it listens). A
/// file that a dead process left is replaced. One with a listener is refused, also if both start at once; the
/// error names the process of a SOCK_STREAM that accepts the connection. Waits at most 2 s for another
/// process that creates a socket in that folder. Owner and group may connect. `option`: the command-line
/// option that names another place.
[[nodiscard]] Result<BoundSocket, AppError> bind_unix_socket(const std::filesystem::path& file, int type,
                                                             const std::string& option = "--socket");

/// Returns a socket connected to `file`. Waits at most `patience` for a listener that accepts no connection,
/// such as a stopped process: then ExitCode::io_failed.
[[nodiscard]] Result<int, AppError> connect_unix_socket(
    const std::filesystem::path& file, int type,
    std::chrono::milliseconds patience = std::chrono::seconds{5});

}  // namespace octoskin
